#pragma once

#include "exact_predicates.h"
#include "spherical_param/types.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>

/// Whether two triangles intersect. For nearly all pairs a few operations and an error bound find a
/// separating plane; exact arithmetic decides about the rest.
namespace spherical_param::internal {

using Eigen::Vector3d;

/// A triangle with what the tests need.
struct Face {
  std::array<Vector3d, 3> corners;  ///< scaled, \see scaleToUnit
  double size;                      ///< at least the longest side of the bounding box
  std::array<Index, 3> vertices;
  Index triangle;
};

using Box = Eigen::AlignedBox3d;

inline Box boxOf(const std::array<Vector3d, 3>& corners) {
  const auto& [a, b, c] = corners;
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

/// \param scale a power of two; coordinates times it are at most 1.
inline Face faceOf(const Positions& points, double scale, const std::array<Index, 3>& vertices,
                   Index triangle) {
  const std::array<Vector3d, 3> corners{scale * points.col(vertices[0]),
                                        scale * points.col(vertices[1]),
                                        scale * points.col(vertices[2])};
  return {corners, boxOf(corners).sizes().maxCoeff(), vertices, triangle};
}

/// The definition of self_intersection.h, in exact arithmetic.
bool intersectExactly(const Face& a, const Face& b);

// --- Quick tests: true means that two triangles do not intersect

inline double largest(const Vector3d& v) {
  return v.cwiseAbs().maxCoeff();
}

/// The plane of a triangle, rounded.
struct Plane {
  Vector3d origin;
  Vector3d normal;
  double error;  ///< bound of that of value(), relative to the distance from the origin

  explicit Plane(const Face& face) : origin(face.corners[0]) {
    const Vector3d u = face.corners[1] - origin;
    const Vector3d v = face.corners[2] - origin;
    normal = u.cross(v);
    // With |u| for the largest coordinate of u: a coordinate of the normal is at most 2 |u| |v| and
    // has an error of up to 8 roundoffs of |u| |v|. So each of the three products of value() with a
    // distance d has an error of 8 + 2 * 4 roundoffs of |u| |v| d. 64 also covers higher powers.
    error = 64.0 * kUnitRoundoff * largest(u) * largest(v) + kUnderflow;
  }
  /// Distance of p from the plane, times the length of the normal.
  double value(const Vector3d& p) const { return normal.dot(p - origin); }
  /// Whether all values are certainly on one side.
  /// \param reach bound of the coordinates of p - origin.
  template <typename... Values>
  bool isBeside(double reach, Values... values) const {
    const double bound = error * reach + kUnderflow;
    return std::min({values...}) > bound || std::max({values...}) < -bound;
  }
};

/// Whether a plane through a common corner v lies between the other corners of two triangles.
///
/// \param reach bound of the coordinates of differences of corners.
inline bool separatedAt(const Vector3d& v, const Vector3d& a1, const Vector3d& a2,
                        const Vector3d& b1, const Vector3d& b2, double reach) {
  // Any direction may be tried. This one is mostly normal to such a plane.
  const Vector3d direction = (a1 - b1) + (a2 - b2);
  // 4 roundings in each of three products of a coordinate of the direction, up to 2 reach, with a
  // distance.
  const double bound = 32.0 * kUnitRoundoff * reach * reach + kUnderflow;
  return std::min(direction.dot(a1 - v), direction.dot(a2 - v)) > bound &&
         std::max(direction.dot(b1 - v), direction.dot(b2 - v)) < -bound;
}

/// Whether a plane across the line between their centres lies between two triangles.
inline bool separated(const Face& a, const Face& b, double reach) {
  const auto& [a0, a1, a2] = a.corners;
  const auto& [b0, b1, b2] = b.corners;
  const Vector3d direction = (a0 - b0) + (a1 - b1) + (a2 - b2);
  const double least = std::min({0.0, direction.dot(a1 - a0), direction.dot(a2 - a0)});
  const double most =
      std::max({direction.dot(b0 - a0), direction.dot(b1 - a0), direction.dot(b2 - a0)});
  // As above, for two distances and a direction up to 3 reach.
  return least - most > 128.0 * kUnitRoundoff * reach * reach + kUnderflow;
}

/// Whether two triangles whose boxes overlap evidently do not intersect.
///
/// \param plane_a of a.
inline bool evidentlyApart(const Face& a, const Plane& plane_a, const Face& b) {
  // The number of common corners, and the sums of their indices in either triangle.
  unsigned common = 0;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j)
      common += a.vertices[i] == b.vertices[j] ? 1U + (i << 8U) + (j << 16U) : 0U;
  const std::size_t of_a = common >> 8U & 0xffU;
  const std::size_t of_b = common >> 16U;
  const double reach = a.size + b.size;
  // The sums are wrong for a triangle that has a vertex twice, but it has no area. Equal corners
  // with different indices do no harm: nothing separates them.
  constexpr std::array<std::size_t, 4> next{1, 2, 0, 1};
  switch (common & 0xffU) {
  case 0:
    return separated(a, b, reach) ||
           plane_a.isBeside(reach, plane_a.value(b.corners[0]), plane_a.value(b.corners[1]),
                            plane_a.value(b.corners[2]));
  case 1: {
    const Vector3d& b1 = b.corners[next[of_b]];
    const Vector3d& b2 = b.corners[next[of_b + 1]];
    return separatedAt(a.corners[of_a], a.corners[next[of_a]], a.corners[next[of_a + 1]], b1, b2,
                       reach) ||
           plane_a.isBeside(reach, plane_a.value(b1), plane_a.value(b2));
  }
  case 2:
    return of_b <= 3 && plane_a.isBeside(reach, plane_a.value(b.corners[3 - of_b]));
  default:
    return false;
  }
}

/// The same, by the planes of both.
inline bool evidentlyApartByBoth(const Face& a, const Plane& plane_a, const Face& b) {
  return evidentlyApart(a, plane_a, b) || evidentlyApart(b, Plane(b), a);
}

/// Whether two triangles intersect.
inline bool intersect(const Face& a, const Plane& plane_a, const Face& b) {
  return !evidentlyApartByBoth(a, plane_a, b) && intersectExactly(a, b);
}

inline bool intersect(const Face& a, const Face& b) {
  return intersect(a, Plane(a), b);
}

/// Whether a box lies on one side of a plane.
inline bool clears(const Plane& plane, const Box& box) {
  const Vector3d center = box.center() - plane.origin;
  const Vector3d half = 0.5 * box.sizes();
  const double reach = plane.normal.cwiseAbs().dot(half);
  const double bound = plane.error * (largest(center) + largest(half));
  return std::abs(plane.normal.dot(center)) > reach + 2.0 * bound;
}

}  // namespace spherical_param::internal
