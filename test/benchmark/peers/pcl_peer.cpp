// benchmark_peer_pcl: the surface reconstruction of the Point Cloud Library.

#include "peer.h"

#include <pcl/common/io.h>
#include <pcl/conversions.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <queue>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using spherical_param::Positions;

constexpr int normal_neighbors = 16;

using Cloud = pcl::PointCloud<pcl::PointNormal>;
using Adjacency = std::vector<std::vector<int>>;

Adjacency neighborGraph(const Cloud::Ptr& cloud) {
  pcl::search::KdTree<pcl::PointNormal> tree;
  tree.setInputCloud(cloud);
  Adjacency adjacency(cloud->size());
  pcl::Indices neighbors;
  std::vector<float> squared_distances;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    tree.nearestKSearch((*cloud)[i], kOrientationNeighbors, neighbors, squared_distances);
    for (const int neighbor : neighbors) {
      adjacency[i].push_back(neighbor);
      adjacency[static_cast<std::size_t>(neighbor)].push_back(static_cast<int>(i));
    }
  }
  return adjacency;
}

void flip(pcl::PointNormal& point) {
  point.getNormalVector3fMap() *= -1.0F;
}

/// Orients the normals along the minimum spanning tree of the neighbour graph, where an edge costs
/// 1 - |n_i . n_j|, from the uppermost point on, whose normal points up (H. Hoppe et al., Surface
/// Reconstruction from Unorganized Points, 1992, section 3.3). PCL itself orients normals to a
/// viewpoint, which a closed surface does not have.
void orientNormals(const Cloud::Ptr& cloud) {
  const Adjacency adjacency = neighborGraph(cloud);
  std::vector<int> from_top(cloud->size());
  std::iota(from_top.begin(), from_top.end(), 0);
  const auto at = [&cloud](int i) -> pcl::PointNormal& {
    return (*cloud)[static_cast<std::size_t>(i)];
  };
  std::sort(from_top.begin(), from_top.end(), [&](int a, int b) { return at(a).z > at(b).z; });

  using Edge = std::tuple<float, int, int>;  // cost, from, to
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
  std::vector<bool> done(cloud->size(), false);
  const auto visit = [&](int i) {
    done[static_cast<std::size_t>(i)] = true;
    for (const int neighbor : adjacency[static_cast<std::size_t>(i)]) {
      if (!done[static_cast<std::size_t>(neighbor)]) {
        const float cosine = at(i).getNormalVector3fMap().dot(at(neighbor).getNormalVector3fMap());
        edges.emplace(1.0F - std::abs(cosine), i, neighbor);
      }
    }
  };
  for (const int top : from_top) {  // the first point of each connected part
    if (done[static_cast<std::size_t>(top)]) {
      continue;
    }
    if (at(top).normal_z < 0.0F) {
      flip(at(top));
    }
    visit(top);
    while (!edges.empty()) {
      const auto [cost, from, to] = edges.top();
      edges.pop();
      if (done[static_cast<std::size_t>(to)]) {
        continue;
      }
      if (at(from).getNormalVector3fMap().dot(at(to).getNormalVector3fMap()) < 0.0F) {
        flip(at(to));
      }
      visit(to);
    }
  }
}

const std::string normals_parameters =
    "NormalEstimationOMP k " + std::to_string(normal_neighbors) +
    " on all cores, oriented along the minimum spanning tree of " +
    std::to_string(kOrientationNeighbors) + " neighbours on 1 thread";

/// The points with normals out of the surface, if it is closed. Points without a normal are left
/// out.
Cloud::Ptr estimateNormals(const Positions& points) {
  const auto positions = pcl::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const Eigen::Vector3f point : points.cast<float>().colwise())
    positions->emplace_back(point.x(), point.y(), point.z());
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

template <typename PointT>
Mesh toMesh(const pcl::PointCloud<PointT>& vertices, const std::vector<pcl::Vertices>& polygons) {
  Mesh mesh{Positions(3, vertices.size()), spherical_param::Triangles(3, polygons.size())};
  for (std::size_t v = 0; v < vertices.size(); ++v)
    mesh.points.col(static_cast<Eigen::Index>(v)) =
        vertices[v].getVector3fMap().template cast<double>();
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      mesh.triangles(static_cast<int>(k), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices.at(k);
  return mesh;
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
PeerResult greedyProjection(const Positions& points) {
  PeerResult result;
  Stopwatch stopwatch;
  const Cloud::Ptr cloud = estimateNormals(points);
  result.normals_seconds = stopwatch.lap();

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
  result.mesh = toMesh(*cloud, polygons);
  result.parameters =
      normals_parameters +
      "; radius 10 mean distances to the nearest neighbour, mu 2.5, 100 neighbours at most, "
      "surface angle 45, angles 10 to 120 degrees";
  return result;
}

PeerResult poisson(const Positions& points) {
  PeerResult result;
  Stopwatch stopwatch;
  const Cloud::Ptr cloud = estimateNormals(points);
  result.normals_seconds = stopwatch.lap();

  constexpr int depth = 8;
  pcl::Poisson<pcl::PointNormal> reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setDepth(depth);
  Cloud vertices;
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(vertices, polygons);
  result.mesh = toMesh(vertices, polygons);
  result.parameters = normals_parameters + "; depth " + std::to_string(depth) +
                      ", 1 thread, all else as PCL sets it";
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  return runPeer(argc, argv, "PCL " PCL_VERSION_PRETTY,
                 {{"gp3", greedyProjection}, {"poisson", poisson}});
}
