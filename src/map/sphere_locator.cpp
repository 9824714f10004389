#include "sphere_locator.h"

#include "index_loops.h"
#include "space_filling_curve.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// Of the coordinates of a unit vector after its normalisation, and of a corner after its own:
/// each less than 1e-15.
constexpr double kRounding = 4e-15;

/// The direction with a largest coordinate of 1/2 to 1, exactly the same, but that coordinates
/// whose products would underflow, so that no triangle might hold it, are 0.
Vector3d scaled(const Vector3d& direction) {
  constexpr double least = 1e-100;
  int exponent = 0;
  std::frexp(direction.cwiseAbs().maxCoeff(), &exponent);
  return direction.unaryExpr([exponent](double coordinate) {
    const double x = std::ldexp(coordinate, -exponent);
    return std::abs(x) < least ? 0.0 : x;
  });
}

/// The direction itself if it is of unit length, up to rounding: a vertex stays that vertex.
Vector3d unitVector(const Vector3d& direction) {
  constexpr double tolerance = 1e-9;
  if (std::abs(direction.squaredNorm() - 1.0) <= tolerance)
    return direction;
  return scaled(direction).normalized();
}

}  // namespace

SphereLocator::SphereLocator(const Positions& sphere, const Triangles& triangles, int threads)
    : sphere_(&sphere), triangles_(&triangles) {
  threads = threadCount(threads, columnCount(triangles));
  Positions centers(3, triangles.cols());
  forEachIndex(columnCount(triangles), threads, [&](Index t) {
    centers.col(t) =
        sphere.col(triangles(0, t)) + sphere.col(triangles(1, t)) + sphere.col(triangles(2, t));
  });
  order_ = mortonOrder(centers);
  tree_ = BoxTree(order_.size(), threads, {}, [&](Index i) { return boxOf(entry(order_, i)); });
}

FloatBox SphereLocator::boxOf(Index triangle) const {
  const auto corner = [&](Index k) -> Vector3d {
    return sphere_->col((*triangles_)(k, triangle)).normalized();
  };
  const Vector3d a = corner(0);
  const Vector3d b = corner(1);
  const Vector3d c = corner(2);
  // A point of the flat triangle with the weights w is by w_a w_b |a - b|^2 + w_b w_c |b - c|^2 +
  // w_c w_a |c - a|^2 <= |longest side|^2 / 3 shorter than the sphere's radius, squared, and its
  // image on the sphere is as far away as its length is less than 1.
  const double longest =
      std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  const double fraction = std::min(1.0, longest / 3.0);
  // 1 - sqrt(1 - fraction), without cancellation.
  const double margin = fraction / (1.0 + std::sqrt(1.0 - fraction)) + kRounding;
  Eigen::AlignedBox3d box(a);
  box.extend(b).extend(c);
  return FloatBox((box.min().array() - margin).matrix().cast<float>(),
                  (box.max().array() + margin).matrix().cast<float>());
}

SphereLocation SphereLocator::locate(const Vector3d& direction) const {
  const Vector3d unit = unitVector(direction);
  const Vector3d exact = scaled(direction);
  SphereLocation hit{-1, Vector3d::Zero()};
  Eigen::Vector3i hit_sides = Eigen::Vector3i::Zero();
  // Only sides and corners are in several triangles.
  const auto is_found = [&](const FloatBox&) { return hit_sides.minCoeff() > 0; };
  const auto visit = [&](Index i) {
    const Index t = entry(order_, i);
    if (hit.triangle >= 0 && hit.triangle < t)
      return;
    const Vector3d a = sphere_->col((*triangles_)(0, t));
    const Vector3d b = sphere_->col((*triangles_)(1, t));
    const Vector3d c = sphere_->col((*triangles_)(2, t));
    Eigen::Vector3i sides;
    if ((sides[0] = determinantSign(exact, b, c)) >= 0 &&
        (sides[1] = determinantSign(exact, c, a)) >= 0 &&
        (sides[2] = determinantSign(exact, a, b)) >= 0) {
      hit.triangle = t;
      hit_sides = sides;
    }
  };
  tree_.forEachOverlapping(FloatBox(unit.normalized().cast<float>()), 0, is_found, visit);
  if (hit.triangle >= 0)
    hit.weights = weightsIn(hit.triangle, unit, hit_sides);
  return hit;
}

Vector3d SphereLocator::weightsIn(Index triangle, const Vector3d& unit,
                                  const Eigen::Vector3i& sides) const {
  // Differences from the direction keep the digits in a tiny triangle. The weights are those of
  // where the ray meets the plane of the corners.
  Eigen::Matrix3d corners;
  for (Index k = 0; k < 3; ++k)
    corners.col(k) = sphere_->col((*triangles_)(k, triangle)) - unit;
  Vector3d weights;
  for (Index k = 0; k < 3; ++k) {
    const double volume = unit.dot(corners.col((k + 1) % 3).cross(corners.col((k + 2) % 3)));
    weights[k] = sides[k] > 0 ? std::max(0.0, volume) : 0.0;
  }
  // If all is rounding: the middle of the sides and corners that are not excluded.
  if (!(weights.sum() > 0.0))
    weights = sides.cwiseMax(0).cast<double>();
  return weights / weights.sum();
}

}  // namespace spherical_param::internal
