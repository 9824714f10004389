#include "triangle_pair.h"

#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector2d;

/// The axis along which a triangle is projected without losing its area; 3 if it has none.
int projectionAxis(const std::array<Vector3d, 3>& t) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto flat = [&](const Vector3d& p) {
      return Vector2d(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    };
    if (orientation2d(flat(t[0]), flat(t[1]), flat(t[2])) != 0)
      return axis;
  }
  return 3;
}

/// A triangle with area, and its plane seen along an axis.
struct ExactTriangle {
  std::array<Vector3d, 3> corners;
  int axis;  ///< of projectionAxis(), below 3

  Vector2d flat(const Vector3d& p) const { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }
  /// Sign of the side of the plane that p is on.
  int side(const Vector3d& p) const { return orientation3d(corners[0], corners[1], corners[2], p); }
  /// Sign of the side of the line from a to b that c is on; all in the plane.
  int turn(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    return orientation2d(flat(a), flat(b), flat(c));
  }
  /// Whether a point of the plane is in the closed triangle.
  bool contains(const Vector3d& p) const {
    const int first = turn(corners[0], corners[1], p);
    const int second = turn(corners[1], corners[2], p);
    const int third = turn(corners[2], corners[0], p);
    return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
  }
};

/// Whether two closed segments in the plane of a triangle, both longer than zero, have a point in
/// common, besides an end of the first inside the triangle that the second is a side of.
bool segmentsCross(const ExactTriangle& plane, const Vector3d& p, const Vector3d& q,
                   const Vector3d& a, const Vector3d& b) {
  const int a_side = plane.turn(p, q, a);
  const int b_side = plane.turn(p, q, b);
  const int p_side = plane.turn(a, b, p);
  const int q_side = plane.turn(a, b, q);
  // On one line they overlap only if an end of one is in the other: of the two ends of the first,
  // contains() knows; if those of the second are in the first, so is a corner, and with it a point
  // of another side, which is not on this line.
  return a_side * b_side <= 0 && p_side * q_side <= 0 && (a_side != 0 || b_side != 0);
}

/// Whether a closed segment and a closed triangle have a point in common.
bool segmentMeets(const Vector3d& p, const Vector3d& q, const ExactTriangle& t) {
  const int p_side = t.side(p);
  const int q_side = t.side(q);
  if (p_side * q_side > 0)
    return false;
  if ((p_side == 0 && t.contains(p)) || (q_side == 0 && t.contains(q)))
    return true;
  const auto& [a, b, c] = t.corners;
  if (p_side == 0 && q_side == 0)
    return segmentsCross(t, p, q, a, b) || segmentsCross(t, p, q, b, c) ||
           segmentsCross(t, p, q, c, a);
  if (p_side == 0 || q_side == 0)
    return false;
  const int first = orientation3d(p, q, a, b);
  const int second = orientation3d(p, q, b, c);
  const int third = orientation3d(p, q, c, a);
  return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
}

}  // namespace

bool intersectExactly(const Face& face_a, const Face& face_b) {
  ExactTriangle a{face_a.corners, projectionAxis(face_a.corners)};
  ExactTriangle b{face_b.corners, projectionAxis(face_b.corners)};
  if (a.axis == 3 || b.axis == 3)
    return false;
  // Common corners to the front, in the same order.
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = common; j < 3; ++j)
      if (a.corners[i] == b.corners[j]) {
        std::swap(a.corners[i], a.corners[common]);
        std::swap(b.corners[j], b.corners[common]);
        ++common;
        break;
      }
  switch (common) {
  case 0:
    // Where two triangles meet, a side of one of them meets the other.
    for (std::size_t i = 0; i < 3; ++i)
      if (segmentMeets(a.corners[i], a.corners[(i + 1) % 3], b) ||
          segmentMeets(b.corners[i], b.corners[(i + 1) % 3], a))
        return true;
    return false;
  case 1:
    return segmentMeets(a.corners[1], a.corners[2], b) ||
           segmentMeets(b.corners[1], b.corners[2], a);
  case 2:
    // The cheap question first: in a flat mesh, neighbours lie on different sides.
    return a.turn(a.corners[0], a.corners[1], a.corners[2]) *
                   a.turn(a.corners[0], a.corners[1], b.corners[2]) >
               0 &&
           a.side(b.corners[2]) == 0;
  default:
    return true;
  }
}

}  // namespace spherical_param::internal
