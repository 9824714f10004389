// Every generated shape, with every weight and by both methods, becomes a sphere through all of its
// points, those that are no sphere included: the scans of the tools, the PCL class and the core
// together.

#include "scan_shapes.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr std::size_t point_count = 1000;

enum class Method { Default, Converged, Paper };

using Case = std::tuple<ShapeInfo, EdgeWeights, Method>;

class ShapesAreMeshed : public testing::TestWithParam<Case> {};

std::string nameOfCase(const testing::TestParamInfo<Case>& info) {
  const char* const weights[] = {"Uniform", "Inverse", "Adaptive"};
  const char* const methods[] = {"ByDefault", "Converged", "AsInThePaper"};
  return std::string(std::get<0>(info.param).name) + "With" +
         weights[static_cast<std::size_t>(std::get<1>(info.param))] +
         methods[static_cast<std::size_t>(std::get<2>(info.param))];
}

std::vector<pcl::Vertices> meshOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& cloud,
                                  EdgeWeights weights, Method method) {
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setWeights(weights);
  if (method == Method::Converged) {
    reconstruction.setTolerance(1e-8);
  }
  // All of the optimisation once for each shape: it takes longest where it is in vain.
  if (method != Method::Default || weights != EdgeWeights::Adaptive) {
    reconstruction.setOptimization(OptimizationMethod::Flips);
  }
  if (method == Method::Paper) {
    reconstruction.setGraphMethod(GraphMethod::NearestNeighbors);
    reconstruction.setSolver(EmbeddingMethod::Iterative);
    reconstruction.setTriangulationMethod(TriangulationMethod::Qhull);
    reconstruction.setOptimization(OptimizationMethod::None);
    reconstruction.setAttempts(1);
    reconstruction.setMaximumIterations(100);
  }
  reconstruction.setInputCloud(cloud);
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(polygons);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  return polygons;
}

TEST_P(ShapesAreMeshed, AsAClosedOutwardSphereThroughAllPoints) {
  const auto& [shape, weights, method] = GetParam();
  ScanOptions options;
  options.shape = shape.shape;
  options.points = point_count;
  const Scan scan = generateScan(options);
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
    const Eigen::Vector3f p = scan.points.col(i).cast<float>();
    cloud->emplace_back(p.x(), p.y(), p.z());
  }
  const std::vector<pcl::Vertices> polygons = meshOf(cloud, weights, method);

  // Every directed edge once and its reverse once, every link one cycle, V - E + F = 2 over all
  // points and positive volume: a closed outward sphere in one piece.
  ASSERT_EQ(polygons.size(), 2 * point_count - 4);
  std::map<std::pair<int, int>, int> third;
  double volume = 0.0;
  for (const pcl::Vertices& polygon : polygons) {
    ASSERT_EQ(polygon.vertices.size(), 3U);
    Eigen::Matrix3d corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = polygon.vertices[k];
      const int b = polygon.vertices[(k + 1) % 3];
      ASSERT_TRUE(third.insert({{a, b}, polygon.vertices[(k + 2) % 3]}).second);
      corners.col(static_cast<Eigen::Index>(k)) = scan.points.col(a);
    }
    volume += corners.col(0).dot(corners.col(1).cross(corners.col(2))) / 6.0;
  }
  EXPECT_GT(volume, 0.0);
  std::vector<int> degree(point_count, 0);
  std::vector<int> neighbor(point_count, -1);
  for (const auto& [edge, apex] : third) {
    ASSERT_EQ(third.count({edge.second, edge.first}), 1U);
    ++degree[static_cast<std::size_t>(edge.first)];
    neighbor[static_cast<std::size_t>(edge.first)] = edge.second;
  }
  std::vector<bool> reached(point_count, false);
  std::vector<int> pending = {0};
  reached[0] = true;
  std::size_t pieces_size = 0;
  while (!pending.empty()) {
    const int v = pending.back();
    pending.pop_back();
    ++pieces_size;
    const int first = neighbor[static_cast<std::size_t>(v)];
    ASSERT_GE(first, 0) << "point " << v << " is no vertex";
    int steps = 0;
    for (int w = first; steps == 0 || w != first; w = third.at({v, w})) {
      ++steps;
      ASSERT_LE(steps, degree[static_cast<std::size_t>(v)]);
      if (!reached[static_cast<std::size_t>(w)]) {
        reached[static_cast<std::size_t>(w)] = true;
        pending.push_back(w);
      }
    }
    EXPECT_EQ(steps, degree[static_cast<std::size_t>(v)]) << "around point " << v;
  }
  EXPECT_EQ(pieces_size, point_count);
  EXPECT_EQ(point_count + polygons.size(), third.size() / 2 + 2);
}

INSTANTIATE_TEST_SUITE_P(
    AllShapes, ShapesAreMeshed,
    testing::Combine(
        testing::ValuesIn(std::vector<ShapeInfo>(allShapes().begin(), allShapes().end())),
        testing::Values(EdgeWeights::Uniform, EdgeWeights::InverseLength, EdgeWeights::Adaptive),
        testing::Values(Method::Default, Method::Converged, Method::Paper)),
    nameOfCase);

}  // namespace
}  // namespace spherical_param::tools
