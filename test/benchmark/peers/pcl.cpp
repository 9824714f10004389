// benchmark_peer_pcl: the surface reconstruction of the Point Cloud Library.

#include "peer.h"

#include <pcl/common/io.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/organized_fast_mesh.h>
#include <pcl/surface/poisson.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using spherical_param::tools::PointData;

constexpr int normal_neighbors = 16;

using Cloud = pcl::PointCloud<pcl::PointNormal>;

/// Orients the normals along the minimum spanning tree of the neighbour graph, where an edge costs
/// 1 - |n_i . n_j|, from the uppermost point on, whose normal points up (H. Hoppe et al., Surface
/// Reconstruction from Unorganized Points, 1992, section 3.3). PCL itself orients normals to a
/// viewpoint, which a closed surface does not have.
void orientNormals(const Cloud::Ptr& cloud) {
  pcl::search::KdTree<pcl::PointNormal> tree;
  tree.setInputCloud(cloud);
  std::vector<std::vector<std::size_t>> adjacency(cloud->size());
  pcl::Indices neighbors;
  std::vector<float> squared_distances;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    tree.nearestKSearch((*cloud)[i], kOrientationNeighbors, neighbors, squared_distances);
    for (const int neighbor : neighbors) {
      adjacency[i].push_back(static_cast<std::size_t>(neighbor));
      adjacency[static_cast<std::size_t>(neighbor)].push_back(i);
    }
  }
  const auto normal = [&](std::size_t i) { return (*cloud)[i].getNormalVector3fMap(); };
  using Edge = std::tuple<float, std::size_t, std::size_t>;  // cost, from, to
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
  std::vector<bool> done(cloud->size(), false);
  const auto visit = [&](std::size_t i, bool is_turned) {
    if (is_turned)
      normal(i) *= -1.0F;
    done[i] = true;
    for (const std::size_t neighbor : adjacency[i])
      if (!done[neighbor])
        edges.emplace(1.0F - std::abs(normal(i).dot(normal(neighbor))), i, neighbor);
  };
  std::vector<std::size_t> from_top(cloud->size());
  std::iota(from_top.begin(), from_top.end(), std::size_t{0});
  std::sort(from_top.begin(), from_top.end(),
            [&](std::size_t a, std::size_t b) { return (*cloud)[a].z > (*cloud)[b].z; });
  for (const std::size_t top : from_top) {  // the first point of each connected part
    if (!done[top])
      visit(top, normal(top).z() < 0.0F);
    while (!edges.empty()) {
      const auto [cost, from, to] = edges.top();
      edges.pop();
      if (!done[to])
        visit(to, normal(from).dot(normal(to)) < 0.0F);
    }
  }
}

const std::string normals_parameters =
    "NormalEstimationOMP k " + std::to_string(normal_neighbors) +
    " on all cores, oriented along the minimum spanning tree of " +
    std::to_string(kOrientationNeighbors) + " neighbours on 1 thread";

pcl::PointCloud<pcl::PointXYZ>::Ptr toPcl(const PointData& data) {
  const auto positions = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const Eigen::Vector3f point = data.position(i).cast<float>();
    positions->emplace_back(point.x(), point.y(), point.z());
  }
  return positions;
}

/// The points with normals out of the surface, if it is closed. Points without a normal are left
/// out.
Cloud::Ptr withNormals(const PointData& data) {
  const auto positions = toPcl(data);
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(positions);
  estimation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(normal_neighbors);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);

  const auto cloud = pcl::make_shared<Cloud>();
  pcl::concatenateFields(*positions, normals, *cloud);
  cloud->erase(std::remove_if(cloud->begin(), cloud->end(),
                              [](const pcl::PointNormal& point) {
                                return !point.getNormalVector3fMap().allFinite();
                              }),
               cloud->end());
  orientNormals(cloud);
  return cloud;
}

template <typename Point>
PeerResult resultOf(const pcl::PointCloud<Point>& vertices,
                    const std::vector<pcl::Vertices>& polygons, const std::string& parameters) {
  PeerResult result;
  result.parameters = parameters;
  result.resize(vertices.size(), polygons.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Eigen::Vector3f point = vertices[v].getVector3fMap();
    result.points.col(static_cast<Eigen::Index>(v)) = point.cast<double>();
  }
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      result.triangles(static_cast<int>(k), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices.at(k);
  return result;
}

/// Mean distance of a point to its nearest neighbour [unit of the cloud].
double meanNeighborDistance(const Cloud& cloud, const pcl::search::KdTree<pcl::PointNormal>& tree) {
  double sum = 0.0;
  pcl::Indices neighbors;
  std::vector<float> squared_distances;
  for (const pcl::PointNormal& point : cloud) {
    tree.nearestKSearch(point, 2, neighbors, squared_distances);  // the first is the point itself
    sum += std::sqrt(static_cast<double>(squared_distances.back()));
  }
  return sum / static_cast<double>(cloud.size());
}

/// Parameters as in PCL's tutorial on fast triangulation, except for the radius, which belongs to
/// its data.
PeerResult greedyProjection(const PointData& data) {
  const Cloud::Ptr cloud = withNormals(data);
  constexpr double radius_factor = 10.0;
  const auto tree = pcl::make_shared<pcl::search::KdTree<pcl::PointNormal>>();
  tree->setInputCloud(cloud);
  pcl::GreedyProjectionTriangulation<pcl::PointNormal> triangulation;
  triangulation.setInputCloud(cloud);
  triangulation.setSearchMethod(tree);
  triangulation.setSearchRadius(radius_factor * meanNeighborDistance(*cloud, *tree));
  triangulation.setMu(2.5);
  triangulation.setMaximumNearestNeighbors(100);
  triangulation.setMaximumSurfaceAngle(M_PI / 4);
  triangulation.setMinimumAngle(M_PI / 18);
  triangulation.setMaximumAngle(2 * M_PI / 3);
  triangulation.setNormalConsistency(false);
  triangulation.setConsistentVertexOrdering(true);  // changes no triangle, only its direction
  std::vector<pcl::Vertices> polygons;
  triangulation.reconstruct(polygons);
  return resultOf(
      *cloud, polygons,
      normals_parameters +
          "; radius 10 mean distances to the nearest neighbour, mu 2.5, 100 neighbours at most, "
          "surface angle 45, angles 10 to 120 degrees");
}

PeerResult poisson(const PointData& data) {
  const Cloud::Ptr cloud = withNormals(data);
  constexpr int depth = 8;
  pcl::Poisson<pcl::PointNormal> reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setDepth(depth);
  Cloud vertices;
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(vertices, polygons);
  return resultOf(vertices, polygons,
                  normals_parameters + "; depth " + std::to_string(depth) +
                      ", 1 thread, all else as PCL sets it");
}

/// Connects neighbours in an image, whose sensor is the origin. The angle tolerance is PCL's: a
/// greatest length of edges, which takes its place, leaves more bridges over jumps in depth.
PeerResult organized(const PointData& data) {
  if (data.rows < 2)
    throw std::runtime_error("the cloud is not organized");
  const auto cloud = toPcl(data);
  cloud->height = static_cast<std::uint32_t>(data.rows);
  cloud->width = static_cast<std::uint32_t>(data.points.size() / data.rows);
  pcl::OrganizedFastMesh<pcl::PointXYZ> mesher;
  mesher.setInputCloud(cloud);
  mesher.setTriangulationType(pcl::OrganizedFastMesh<pcl::PointXYZ>::TRIANGLE_ADAPTIVE_CUT);
  std::vector<pcl::Vertices> polygons;
  mesher.reconstruct(polygons);
  pcl::PointCloud<pcl::PointXYZ> seen;
  std::vector<pcl::index_t> number(cloud->size());
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    number[i] = static_cast<pcl::index_t>(seen.size());
    if (pcl::isFinite((*cloud)[i]))
      seen.push_back((*cloud)[i]);
  }
  for (pcl::Vertices& polygon : polygons)
    for (pcl::index_t& vertex : polygon.vertices)
      vertex = number[static_cast<std::size_t>(vertex)];
  return resultOf(seen, polygons, "adaptive cut, angle tolerance 12.5 degrees (default), 1 thread");
}

}  // namespace

int main(int argc, char** argv) {
  return runPeer(argc, argv, "PCL " PCL_VERSION_PRETTY,
                 {{"gp3", greedyProjection}, {"organized", organized}, {"poisson", poisson}});
}
