#include "rotation_search.h"

#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::Mapped;

Matrix3d found(const SphereSurface& first, const SphereSurface& second) {
  return searchRotation(first, second, {}, 0, {});
}

TEST(RotationSearch, ErrorIsTheMeanSquaredDistanceAtArea1) {
  // Points of a sphere of area 1 that is turned: the mean of |u - R u|^2 is 4/3 (1 - cos angle).
  const Mapped mesh = test::mapped(test::spiralSphere(16000));
  Mapped other = mesh;
  other.points = (3.0 * other.points).colwise() + Vector3d(1.0, -2.0, 5.0);
  for (const double angle : {0.0, 0.3, 3.0}) {
    const double expected = 4.0 / 3.0 * (1.0 - std::cos(angle)) / (4.0 * test::kPi);
    EXPECT_NEAR(alignmentError(mesh.surface(), other.surface(),
                               test::rotationBy(angle, {1.0, 2.0, 3.0}), 0),
                expected, 1e-3 * expected + 1e-12);
  }
}

TEST(RotationSearch, NoOtherRotationIsBetterAndExchangingTheSurfacesInvertsIt) {
  const SphereSurface first = test::firstBlob().over(test::spiralSphere(600)).surface();
  const SphereSurface second = test::secondBlob().over(test::spiralSphere(500)).surface();
  const Matrix3d rotation = found(first, second);
  const Matrix3d back = found(second, first);
  EXPECT_LT((rotation * back - Matrix3d::Identity()).norm(), 1e-5);
  const double error = alignmentError(first, second, rotation, 0);
  EXPECT_NEAR(error, alignmentError(second, first, back, 0), 1e-9);

  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond other(normal(random), normal(random), normal(random), normal(random));
    EXPECT_GT(alignmentError(first, second, other.normalized().toRotationMatrix(), 0), error);
  }
}

TEST(RotationSearch, PairsDecideWhereTheShapesDoNot) {
  // All rotations of a sphere are as good.
  const Mapped mesh = test::mapped(test::spiralSphere(300));
  const SphereSurface sphere = mesh.surface();
  const Matrix3d rotation = test::rotationBy(2.0, {1.0, -2.0, 0.5});
  std::vector<std::pair<Vector3d, Vector3d>> pairs;
  for (const Vector3d& u : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)})
    pairs.emplace_back(u, rotation * u);
  const SphereSurface turned = transformed(mesh, rotation).surface();
  EXPECT_LT((searchRotation(sphere, turned, pairs, 0, {}) - rotation).norm(), 1e-5);
}

}  // namespace
}  // namespace spherical_param::internal
