#include "reference/self_intersection.h"

#include "exact_predicates.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace spherical_param::reference {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using internal::orientation2d;
using internal::orientation3d;

/// Without one of its coordinates.
Vector2d seenAlong(int axis, const Vector3d& p) {
  return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

struct Triangle {
  std::array<Vector3d, 3> corners;
  Vector3d low;
  Vector3d high;
  int axis;  ///< along which it is seen with an area; 3: it has none

  explicit Triangle(const std::array<Vector3d, 3>& of) : corners(of), axis(0) {
    low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    while (axis < 3 && turn(corners[0], corners[1], corners[2]) == 0)
      ++axis;
  }
  int side(const Vector3d& p) const { return orientation3d(corners[0], corners[1], corners[2], p); }
  int turn(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    return orientation2d(seenAlong(axis, a), seenAlong(axis, b), seenAlong(axis, c));
  }
};

/// Whether all signs but zeros are the same.
bool agree(int a, int b, int c) {
  return std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0;
}

/// Whether closed segments in the plane of a triangle have a point in common.
bool segmentsMeet(const Triangle& plane, const Vector3d& p, const Vector3d& q, const Vector3d& a,
                  const Vector3d& b) {
  const int of_a = plane.turn(p, q, a);
  const int of_b = plane.turn(p, q, b);
  const int of_p = plane.turn(a, b, p);
  const int of_q = plane.turn(a, b, q);
  if (of_a != 0 || of_b != 0)
    return of_a * of_b <= 0 && of_p * of_q <= 0;
  // On one line.
  return (p.cwiseMin(q).array() <= a.cwiseMax(b).array()).all() &&
         (a.cwiseMin(b).array() <= p.cwiseMax(q).array()).all();
}

bool segmentMeets(const Vector3d& p, const Vector3d& q, const Triangle& t) {
  const auto& [a, b, c] = t.corners;
  const int of_p = t.side(p);
  const int of_q = t.side(q);
  if (of_p * of_q > 0)
    return false;
  if (of_p != 0 || of_q != 0)
    // The line runs through the triangle if it has all of its sides on one hand.
    return agree(orientation3d(p, q, a, b), orientation3d(p, q, b, c), orientation3d(p, q, c, a));
  return agree(t.turn(a, b, p), t.turn(b, c, p), t.turn(c, a, p)) || segmentsMeet(t, p, q, a, b) ||
         segmentsMeet(t, p, q, b, c) || segmentsMeet(t, p, q, c, a);
}

/// The definition of the header, of triangles with area.
bool intersect(Triangle a, Triangle b) {
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = common; j < 3; ++j)
      if (a.corners[i] == b.corners[j]) {
        std::swap(a.corners[i], a.corners[common]);
        std::swap(b.corners[j], b.corners[common]);
        ++common;
        break;
      }
  if (common == 0) {
    for (std::size_t i = 0; i < 3; ++i)
      if (segmentMeets(a.corners[i], a.corners[(i + 1) % 3], b) ||
          segmentMeets(b.corners[i], b.corners[(i + 1) % 3], a))
        return true;
    return false;
  }
  if (common == 1)
    return segmentMeets(a.corners[1], a.corners[2], b) ||
           segmentMeets(b.corners[1], b.corners[2], a);
  if (common == 2)
    return a.side(b.corners[2]) == 0 && a.turn(a.corners[0], a.corners[1], a.corners[2]) ==
                                            a.turn(a.corners[0], a.corners[1], b.corners[2]);
  return true;
}

}  // namespace

std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles) {
  std::vector<Triangle> all;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    all.emplace_back(std::array<Vector3d, 3>{
        points.col(triangles(0, t)), points.col(triangles(1, t)), points.col(triangles(2, t))});
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t s, std::size_t t) { return all[s].low.x() < all[t].low.x(); });
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Triangle& a = all[order[i]];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Triangle& b = all[order[j]];
      if (b.low.x() > a.high.x())
        break;
      if (a.axis == 3 || b.axis == 3 || (a.low.array() > b.high.array()).any() ||
          (b.low.array() > a.high.array()).any() || !intersect(a, b))
        continue;
      const auto [low, high] = std::minmax(order[i], order[j]);
      pairs.push_back({static_cast<Index>(low), static_cast<Index>(high)});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace spherical_param::reference
