// benchmark_peer_open3d: the surface reconstruction of Open3D.

#include "peer.h"

#include <open3d/Open3DConfig.h>
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>

#include <unistd.h>

#include <cstdlib>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace spherical_param::benchmark;
using open3d::geometry::PointCloud;
using open3d::geometry::TriangleMesh;
using spherical_param::tools::PointData;

constexpr int normal_neighbors = 30;  // default of Open3D

const std::string normals_parameters =
    "EstimateNormals " + std::to_string(normal_neighbors) +
    " neighbours on all cores, OrientNormalsConsistentTangentPlane " +
    std::to_string(kOrientationNeighbors) + " neighbours on 1 thread";

/// The points with normals.
PointCloud withNormals(const PointData& data) {
  PointCloud cloud;
  for (std::size_t i = 0; i < data.points.size(); ++i)
    cloud.points_.emplace_back(data.position(i));
  cloud.EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(normal_neighbors));
  cloud.OrientNormalsConsistentTangentPlane(kOrientationNeighbors);
  return cloud;
}

PeerResult resultOf(const TriangleMesh& surface, const std::string& parameters) {
  PeerResult result;
  result.parameters = normals_parameters + parameters;
  result.resize(surface.vertices_.size(), surface.triangles_.size());
  for (std::size_t v = 0; v < surface.vertices_.size(); ++v)
    result.points.col(static_cast<Eigen::Index>(v)) = surface.vertices_[v];
  for (std::size_t t = 0; t < surface.triangles_.size(); ++t)
    result.triangles.col(static_cast<Eigen::Index>(t)) = surface.triangles_[t];
  return result;
}

/// Radii as in Open3D's tutorial on surface reconstruction.
PeerResult ballPivoting(const PointData& data) {
  const PointCloud cloud = withNormals(data);
  const std::vector<double> distances = cloud.ComputeNearestNeighborDistance();
  const double mean_distance = std::accumulate(distances.begin(), distances.end(), 0.0) /
                               static_cast<double>(distances.size());
  const double radius = 1.5 * mean_distance;
  return resultOf(*TriangleMesh::CreateFromPointCloudBallPivoting(cloud, {radius, 2.0 * radius}),
                  "; radii 1.5 and 3 mean distances to the nearest neighbour; 1 thread");
}

PeerResult poisson(const PointData& data) {
  const PointCloud cloud = withNormals(data);
  constexpr std::size_t depth = 8;
  return resultOf(*std::get<0>(TriangleMesh::CreateFromPointCloudPoisson(cloud, depth)),
                  "; depth " + std::to_string(depth) +
                      ", all else as Open3D sets it; all cores, waiting threads sleep");
}

/// Lets threads sleep while they wait. By default those of OpenMP spin, which makes Poisson up to
/// 50 times slower as soon as another program runs. OpenMP reads this when a program starts, hence
/// the second start.
void letWaitingThreadsSleep(char** argv) {
  constexpr const char* variable = "OMP_WAIT_POLICY";
  if (std::getenv(variable) == nullptr && setenv(variable, "passive", 0) == 0)
    execv("/proc/self/exe", argv);
}

}  // namespace

int main(int argc, char** argv) {
  letWaitingThreadsSleep(argv);
  return runPeer(argc, argv, "Open3D " OPEN3D_VERSION,
                 {{"ball_pivoting", ballPivoting}, {"poisson", poisson}});
}
