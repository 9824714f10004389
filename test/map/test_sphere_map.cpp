#include "spherical_param/map/sphere_map.h"

#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::Mapped;

SphereMap mapOf(const Mapped& mesh, const SphereMapOptions& options = {}) {
  return computeSphereMap(mesh.points, mesh.triangles, mesh.sphere, options);
}

SphereMapOptions withWeight(double area_weight, int sweeps = 15) {
  SphereMapOptions options;
  options.area_weight = area_weight;
  options.sweeps = sweeps;
  return options;
}

/// The map of a mesh, which has to be one to one.
SphereMap soundMapOf(const Mapped& mesh, const SphereMapOptions& options = {}) {
  SphereMap map = mapOf(mesh, options);
  EXPECT_EQ(map.sphere.cols(), mesh.points.cols());
  EXPECT_TRUE(test::isOneToOne(map.sphere, mesh.triangles));
  EXPECT_EQ(map.distortion.flipped_triangles, 0);
  return map;
}

Mapped stretchedSphere(int parts, const Vector3d& axes) {
  Mapped mesh = test::octasphere(parts);
  mesh.points = axes.asDiagonal() * mesh.points;
  mesh.sphere = mesh.points.colwise().normalized();
  return mesh;
}

TEST(SphereMap, KeepsTheAreasOfAnEllipsoidAndOfANeedle) {
  const SphereMap map = soundMapOf(stretchedSphere(16, {1.0, 1.0, 3.0}));
  EXPECT_GT(map.before.area.mean, 1.5);
  EXPECT_LT(map.distortion.area.mean, 1.1);
  EXPECT_LT(map.distortion.angle.mean, 2.5);
  const SphereMap of_needle = soundMapOf(stretchedSphere(16, {1.0, 1.0, 60.0}));
  EXPECT_LT(of_needle.distortion.area.mean, 0.5 * of_needle.before.area.mean);
}

TEST(SphereMap, KeepsTheAreaOfTheEndOfALimbFromAnyStart) {
  // A tube bent to a half circle, 20 times as long as it is thick: a conformal map would shrink its
  // ends by e^20.
  const test::Mesh tube = test::bentTube(40.0, test::kPi, 12);
  const auto n = static_cast<Index>(tube.points.cols());
  const SphereMap map = soundMapOf({tube.points, tube.triangles, test::randomSphere(n, 5)});
  EXPECT_GT(map.before.flipped_triangles, 0);
  EXPECT_LT(map.distortion.area.mean, 2.5);
}

TEST(SphereMap, WeightOfAreasTradesThemForAngles) {
  const test::Mesh tube = test::bentTube(12.0, 0.0, 16);
  const Positions start = (tube.points.colwise() - Vector3d(6.0, 0.0, 0.0)).colwise().normalized();
  double angle = 1.0;
  double area = std::numeric_limits<double>::infinity();
  for (const double weight : {0.0, 0.5, 0.9}) {
    const MapDistortion distortion =
        soundMapOf({tube.points, tube.triangles, start}, withWeight(weight)).distortion;
    EXPECT_GT(distortion.angle.mean, angle);
    EXPECT_LT(distortion.area.mean, area);
    angle = distortion.angle.mean;
    area = distortion.area.mean;
  }
}

TEST(SphereMap, IsOneToOneForAnyPositionsWeightAndSweeps) {
  Mapped mesh = test::octasphere(8);
  const auto n = static_cast<Index>(mesh.points.cols());
  for (const std::uint64_t seed : {1U, 2U})
    for (const int sweeps : {0, 1, 15})
      for (const double weight : {0.0, 0.85, 1.0}) {
        mesh.points = test::randomPositions(n, seed);
        mesh.sphere = test::randomSphere(n, seed);
        const SphereMap map = soundMapOf(mesh, withWeight(weight, sweeps));
        for (const SphereMapLevel& level : map.levels)
          EXPECT_LE(level.sweeps, sweeps);
      }
}

TEST(SphereMap, SmallestMeshesAndAVertexOfManyNeighborsAreMapped) {
  soundMapOf(test::mapped(test::regularTetrahedron()));
  EXPECT_LT(soundMapOf(test::octasphere(1)).distortion.angle.mean, 1.05);
  for (const Index ring : {3, 4, 5, 1000})
    soundMapOf(test::doubleCone(ring));
}

TEST(SphereMap, TrianglesWithoutAreaAndTinyClustersHaveRoom) {
  // Rows of collinear points on an octahedron, with all of its upper half in the plane; then all of
  // it on a line, then in a point.
  Mapped mesh = test::octasphere(8);
  for (Eigen::Index v = 0; v < mesh.points.cols(); ++v)
    mesh.points.col(v) /= mesh.points.col(v).lpNorm<1>();
  mesh.points.row(2) = mesh.points.row(2).cwiseMin(0.0);
  mesh.points.row(0) = (2.0 * mesh.points.row(0)).array().round() / 2.0;
  EXPECT_GT(soundMapOf(mesh).distortion.degenerate_triangles, 0);
  mesh.points.topRows(2).setZero();
  soundMapOf(mesh);
  mesh.points.setZero();
  soundMapOf(mesh);

  Mapped cluster = test::octasphere(16);
  for (Eigen::Index v = 0; v < cluster.points.cols(); ++v)
    if (cluster.points(2, v) > 0.7)
      cluster.points.col(v) =
          Vector3d::UnitZ() + 1e-9 * (cluster.points.col(v) - Vector3d::UnitZ());
  soundMapOf(cluster);
}

TEST(SphereMap, TurnsWithItsStartAndNotWithTheMesh) {
  Mapped mesh = stretchedSphere(16, {1.0, 1.5, 2.5});
  // Nothing is symmetric, so that rounding breaks no ties.
  mesh.points = test::withNoise(mesh.points, 0.002, 6);
  const Eigen::Matrix3d turn = test::rotationBy(1.2, {3.0, -1.0, 2.0});
  const Positions sphere = mesh.sphere;
  const SphereMap map = mapOf(mesh);
  // Also where the start is mirrored.
  for (const double sign : {1.0, -1.0}) {
    mesh.sphere = sign * sphere;
    const Positions expected = turn * mapOf(mesh).sphere;
    mesh.sphere = sign * turn * sphere;
    EXPECT_LT((mapOf(mesh).sphere - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
  const SphereMap of_mesh = mapOf({1e6 * turn * mesh.points, mesh.triangles, sphere});
  // Rounding may change the order of the collapses of a few vertices.
  EXPECT_LT((of_mesh.sphere - map.sphere).cwiseAbs().maxCoeff(), 0.02);
}

}  // namespace
}  // namespace spherical_param
