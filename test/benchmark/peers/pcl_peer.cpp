// benchmark_peer_pcl: the surface reconstruction of the Point Cloud Library.

#include "pcl_normals.h"
#include "peer.h"

#include <pcl/conversions.h>
#include <pcl/pcl_config.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using spherical_param::tools::TriangleMesh;
using Cloud = pcl::PointCloud<pcl::PointNormal>;

template <typename PointT>
TriangleMesh toMesh(const pcl::PointCloud<PointT>& vertices,
                    const std::vector<pcl::Vertices>& polygons) {
  TriangleMesh mesh;
  mesh.vertices.points.reserve(vertices.size());
  for (const PointT& point : vertices) {
    mesh.vertices.points.push_back({point.x, point.y, point.z});
  }
  mesh.triangles.reserve(polygons.size());
  for (const pcl::Vertices& polygon : polygons) {
    const pcl::Indices& corners = polygon.vertices;
    mesh.triangles.push_back({corners.at(0), corners.at(1), corners.at(2)});
  }
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
PeerResult greedyProjection(const Points& points) {
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
      pcl_normals_parameters +
      "; radius 10 mean distances to the nearest neighbour, mu 2.5, 100 neighbours at most, "
      "surface angle 45, angles 10 to 120 degrees";
  return result;
}

PeerResult poisson(const Points& points) {
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
  result.parameters = pcl_normals_parameters + "; depth " + std::to_string(depth) +
                      ", 1 thread, all else as PCL sets it";
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  return runPeer(argc, argv,
                 {"benchmark_peer_pcl",
                  "PCL " PCL_VERSION_PRETTY,
                  {{"gp3", "PCL greedy projection", true, greedyProjection},
                   {"poisson", "PCL Poisson", false, poisson}}});
}
