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

/// Bound of the rounding of a unit vector's coordinates and of a corner's, each less than 1e-15.
constexpr double kRounding = 4e-15;

/// The direction, scaled exactly to a largest coordinate of 1/2 to 1. Coordinates whose products
/// would underflow become 0: with them, perhaps no triangle would hold the direction.
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

/// The box of a spherical triangle.
FloatBox boxOf(const Eigen::Matrix3d& corners) {
  const Vector3d a = corners.col(0).normalized();
  const Vector3d b = corners.col(1).normalized();
  const Vector3d c = corners.col(2).normalized();
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

/// Weights of the corners of a triangle at a direction.
/// \param sides signs of the determinants of the direction and the side opposite to each corner
Vector3d weightsIn(Eigen::Matrix3d corners, const Vector3d& unit, const Eigen::Vector3i& sides) {
  // Differences from the direction keep the digits in a tiny triangle. The weights are those of
  // where the ray meets the plane of the corners.
  corners.colwise() -= unit;
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
  tree_ = BoxTree(order_.size(), threads, {},
                  [&](Index i) { return boxOf(corners(entry(order_, i))); });
}

Eigen::Matrix3d SphereLocator::corners(Index triangle) const {
  Eigen::Matrix3d result;
  for (Index k = 0; k < 3; ++k)
    result.col(k) = sphere_->col((*triangles_)(k, triangle));
  return result;
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
    const Eigen::Matrix3d of = corners(t);
    Eigen::Vector3i sides;
    if ((sides[0] = determinantSign(exact, of.col(1), of.col(2))) >= 0 &&
        (sides[1] = determinantSign(exact, of.col(2), of.col(0))) >= 0 &&
        (sides[2] = determinantSign(exact, of.col(0), of.col(1))) >= 0) {
      hit.triangle = t;
      hit_sides = sides;
    }
  };
  tree_.forEachOverlapping(FloatBox(unit.normalized().cast<float>()), 0, is_found, visit);
  if (hit.triangle >= 0)
    hit.weights = weightsIn(corners(hit.triangle), unit, hit_sides);
  return hit;
}

}  // namespace spherical_param::internal
