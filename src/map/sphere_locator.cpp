#include "sphere_locator.h"

#include "index_loops.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

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
  const std::size_t count = columnCount(triangles);
  // A leaf has four triangles at most.
  while (count > std::size_t{4} << levels_)
    ++levels_;
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), Index{0});
  boxes_.resize(std::size_t{2} << levels_);
  Positions centers(3, triangles.cols());
  threads = threadCount(threads, count);
  forEachIndex(count, threads, [&](Index t) {
    centers.col(t) =
        sphere.col(triangles(0, t)) + sphere.col(triangles(1, t)) + sphere.col(triangles(2, t));
  });
  for (unsigned level = 0; level < levels_; ++level)
    forEachTask(std::size_t{1} << level, threads,
                [&](std::size_t i) { split((std::size_t{1} << level) + i, level, centers); });
  for (unsigned level = levels_ + 1; level-- > 0;)
    forEachItem(std::size_t{1} << level, threads, {},
                [&](std::size_t i) { makeBox((std::size_t{1} << level) + i); });
}

std::size_t SphereLocator::begin(std::size_t leaf) const {
  return order_.size() * leaf >> levels_;
}

void SphereLocator::split(std::size_t node, unsigned level, const Positions& centers) {
  const std::size_t leaves = std::size_t{1} << (levels_ - level);
  const std::size_t first_leaf = (node << (levels_ - level)) - (std::size_t{1} << levels_);
  const auto at = [&](std::size_t leaf) { return order_.data() + begin(leaf); };
  Index* const first = at(first_leaf);
  Index* const end = at(first_leaf + leaves);
  Vector3d lower = centers.col(*first);
  Vector3d upper = lower;
  for (const Index* i = first; i != end; ++i) {
    lower = lower.cwiseMin(centers.col(*i));
    upper = upper.cwiseMax(centers.col(*i));
  }
  Eigen::Index axis = 0;
  (upper - lower).maxCoeff(&axis);
  std::nth_element(first, at(first_leaf + leaves / 2), end, [&](Index a, Index b) {
    const double at_a = centers(axis, a);
    const double at_b = centers(axis, b);
    return at_a != at_b ? at_a < at_b : a < b;
  });
}

void SphereLocator::makeBox(std::size_t node) {
  const std::size_t first_leaf = std::size_t{1} << levels_;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const auto add = [&](const Box& part) {
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], part.lower[axis]);
      box.upper[axis] = std::max(box.upper[axis], part.upper[axis]);
    }
  };
  if (node < first_leaf) {
    add(boxes_[2 * node]);
    add(boxes_[2 * node + 1]);
  } else {
    for (std::size_t i = begin(node - first_leaf); i < begin(node - first_leaf + 1); ++i)
      add(boxOf(order_[i]));
  }
  boxes_[node] = box;
}

SphereLocator::Box SphereLocator::boxOf(Index triangle) const {
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
  const Vector3d lower = a.cwiseMin(b).cwiseMin(c);
  const Vector3d upper = a.cwiseMax(b).cwiseMax(c);
  Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = lower[axis] - margin;
    box.upper[axis] = upper[axis] + margin;
  }
  return box;
}

SphereHit SphereLocator::locate(const Vector3d& direction) const {
  const Vector3d unit = unitVector(direction);
  const Vector3d exact = scaled(direction);
  const Vector3d place = unit.normalized();
  const double x = place.x();
  const double y = place.y();
  const double z = place.z();
  const auto contains = [&](const Box& box) {
    // Without branches, which would be mispredicted.
    return ((box.lower[0] <= x) & (x <= box.upper[0]) & (box.lower[1] <= y) & (y <= box.upper[1]) &
            (box.lower[2] <= z) & (z <= box.upper[2])) != 0;
  };

  SphereHit hit;
  Eigen::Vector3i hit_sides;
  const std::size_t first_leaf = std::size_t{1} << levels_;
  std::array<std::size_t, std::numeric_limits<Index>::digits + 2> stack{};
  std::size_t size = 0;
  stack[size++] = 1;
  bool is_inside = false;
  while (size > 0 && !is_inside) {
    const std::size_t node = stack[--size];
    if (node < first_leaf) {
      for (const std::size_t part : {2 * node + 1, 2 * node})
        if (contains(boxes_[part]))
          stack[size++] = part;
      continue;
    }
    for (std::size_t i = begin(node - first_leaf); i < begin(node - first_leaf + 1); ++i) {
      const Index t = order_[i];
      if (hit.triangle >= 0 && hit.triangle < t)
        continue;
      const Vector3d a = sphere_->col((*triangles_)(0, t));
      const Vector3d b = sphere_->col((*triangles_)(1, t));
      const Vector3d c = sphere_->col((*triangles_)(2, t));
      Eigen::Vector3i sides;
      if ((sides[0] = determinantSign(exact, b, c)) < 0 ||
          (sides[1] = determinantSign(exact, c, a)) < 0 ||
          (sides[2] = determinantSign(exact, a, b)) < 0)
        continue;
      hit.triangle = t;
      hit_sides = sides;
      is_inside = sides[0] > 0 && sides[1] > 0 && sides[2] > 0;
      if (is_inside)
        break;
    }
  }
  if (hit.triangle < 0)
    return hit;

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
