#include "rotation_search.h"

#include "blobs.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace spherical_param::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::Blob;
using test::Mapped;

Matrix3d found(const SphereSurface& first, const SphereSurface& second) {
  return searchRotation(first, second, {}, 0, {});
}

TEST(RotationSearch, FindsTheRotationOfAnotherSampling) {
  // Size and place are free.
  const Matrix3d rotation = test::rotationBy(2.2, {0.2, -1.0, 0.4});
  Mapped other =
      test::firstBlob().over(test::rotationBy(1.0, {1, 1, 0}) * test::spiralSphere(1500));
  other.points = (7.0 * other.points).colwise() + Vector3d(3, -50, 8);
  other.sphere = (rotation * other.sphere).colwise().normalized();
  const SphereSurface first = test::firstBlob().over(test::spiralSphere(2000)).surface();
  const SphereSurface second = other.surface();
  const Matrix3d result = found(first, second);
  EXPECT_LT((result - rotation).norm(), 1e-2);
  EXPECT_LT(alignmentError(first, second, result, 0), 1e-4);
}

/// The vertices of a shape, each of which counts as much as a third of its triangles.
struct Samples {
  Mapped mesh;
  Eigen::VectorXd weights;
  Vector3d center;
  double scale;

  explicit Samples(const Blob& blob)
      : mesh(blob.over(test::spiralSphere(400))), weights(Eigen::VectorXd::Zero(400)) {
    const double area = surfaceArea(mesh.points, mesh.triangles);
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
      for (int k = 0; k < 3; ++k)
        weights[mesh.triangles(k, t)] +=
            surfaceArea(mesh.points, mesh.triangles.col(t)) / 3.0 / area;
    center = mesh.points * weights;
    scale = 1.0 / std::sqrt(area);
  }

  /// Mean squared distance from another shape, turned.
  double distanceFrom(const Samples& other, const Blob& blob, const Matrix3d& rotation) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const Vector3d u = rotation * mesh.sphere.col(i);
      sum += weights[i] * (scale * (mesh.points.col(i) - center) -
                           other.scale * (blob.radius(u) * u - other.center))
                              .squaredNorm();
    }
    return sum;
  }
};

TEST(RotationSearch, NoOtherRotationIsBetterAndExchangingTheSurfacesInvertsIt) {
  const SphereSurface first = test::firstBlob().over(test::spiralSphere(1500)).surface();
  const SphereSurface second = test::secondBlob().over(test::spiralSphere(1300)).surface();
  const Matrix3d rotation = found(first, second);
  const Matrix3d back = found(second, first);
  EXPECT_LT((rotation * back - Matrix3d::Identity()).norm(), 1e-5);
  const double error = alignmentError(first, second, rotation, 0);
  EXPECT_NEAR(error, alignmentError(second, first, back, 0), 1e-9);

  const Samples of_first(test::firstBlob());
  const Samples of_second(test::secondBlob());
  const auto error_of = [&](const Matrix3d& turn) {
    return 0.5 * (of_first.distanceFrom(of_second, test::secondBlob(), turn) +
                  of_second.distanceFrom(of_first, test::firstBlob(), turn.transpose()));
  };
  EXPECT_NEAR(error_of(rotation), error, 0.02 * error);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i)
    best = std::min(best, error_of(Eigen::Quaterniond(normal(random), normal(random),
                                                      normal(random), normal(random))
                                       .normalized()
                                       .toRotationMatrix()));
  for (int i = 0; i < 200; ++i)
    best = std::min(best, error_of(test::rotationBy(0.1 * normal(random),
                                                    {normal(random), normal(random), 0.5}) *
                                   rotation));
  // Both integrals have errors of their own.
  EXPECT_LT(error_of(rotation), best * 1.002);
}

TEST(RotationSearch, PairsDecideWhereTheShapesDoNot) {
  // All rotations of a sphere are as good.
  Mapped mesh = test::mapped(test::spiralSphere(300));
  const SphereSurface sphere = mesh.surface();
  const Matrix3d rotation = test::rotationBy(2.0, {1.0, -2.0, 0.5});
  std::vector<std::pair<Vector3d, Vector3d>> pairs;
  for (const Vector3d& u : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)})
    pairs.emplace_back(u, rotation * u);
  mesh.sphere = (rotation * mesh.sphere).colwise().normalized();
  EXPECT_LT((searchRotation(sphere, mesh.surface(), pairs, 0, {}) - rotation).norm(), 1e-5);
}

}  // namespace
}  // namespace spherical_param::internal
