#include "common/mesh_distance.h"

#include "spherical_param/map/resampling.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

/// The octahedron |x| + |y| + |z| = 1 in many triangles.
SphereSurface octahedron() {
  const GridSphere grid = makeGridSphere(SphereGrid::Octahedral, 16);
  const Positions points =
      grid.directions.array().rowwise() / grid.directions.cwiseAbs().colwise().sum().array();
  return {points, grid.triangles, grid.directions, {SurfaceFit::Linear, 1}};
}

TEST(MeshDistance, IsThatOfTheNearestTriangleAlsoFromOneBeside) {
  const SphereSurface surface = octahedron();
  // Before a face, an edge, a corner, inside, and on the surface.
  const std::vector<std::pair<Eigen::Vector3d, double>> points = {
      {{1.0, 1.1, 0.9}, 2.0 / std::sqrt(3.0)},
      {{-1.0, 1.0, 0.0}, std::sqrt(0.5)},
      {{0.02, 0.03, -2.0}, std::sqrt(1.0 + 0.02 * 0.02 + 0.03 * 0.03)},
      {{0.3, -0.3, 0.2}, 0.2 / std::sqrt(3.0)},
      {{0.5, 0.25, -0.25}, 0.0}};
  for (const auto& [point, distance] : points)
    for (const double turn : {0.0, 0.3}) {  // [rad], more than three triangles
      const Eigen::Vector3d direction =
          Eigen::AngleAxisd(turn, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()) *
          point.normalized();
      const DistanceStatistics one = distanceFromMesh(point, direction, surface);
      for (const double value : {one.mean, one.rms, one.max})
        EXPECT_NEAR(value, distance, 1e-12) << point.transpose();
    }
  Positions two(3, 2);
  two << points[1].first, points[4].first;
  const DistanceStatistics statistics = distanceFromMesh(two, two.colwise().normalized(), surface);
  EXPECT_NEAR(statistics.mean, std::sqrt(0.5) / 2.0, 1e-12);
  EXPECT_NEAR(statistics.rms, 0.5, 1e-12);
  EXPECT_NEAR(statistics.max, std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace spherical_param::tools
