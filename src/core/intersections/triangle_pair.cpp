#include "triangle_pair.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector2d;

/// A triangle, and its projection along an axis.
class ExactTriangle {
public:
  explicit ExactTriangle(const std::array<Vector3d, 3>& corners) : corners_(corners) {
    // The largest projection first, which mostly needs no exact arithmetic.
    const auto& [a, b, c] = corners;
    (b - a).cross(c - a).cwiseAbs().maxCoeff(&axis_);
    for (int i = 0; i < 3 && (turn_ = turn(a, b, c)) == 0; ++i)
      axis_ = (axis_ + 1) % 3;
  }

  bool hasArea() const { return turn_ != 0; }
  /// Sign of the side of the plane that p is on.
  int side(const Vector3d& p) const {
    return orientation3d(corners_[0], corners_[1], corners_[2], p);
  }
  /// Sign of the side of the line from a to b that c is on; all in the plane.
  int turn(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    return orientation2d(flat(a), flat(b), flat(c));
  }
  /// Whether this triangle and a point, a segment or a triangle in its plane are disjoint: then a
  /// line along a side of one of them separates them.
  template <std::size_t N>
  bool isApart(const std::array<Vector3d, N>& hull) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (std::all_of(hull.begin(), hull.end(), [&](const Vector3d& p) {
            return turn(corners_[i], corners_[(i + 1) % 3], p) == -turn_;
          }))
        return true;
    for (std::size_t i = 0; N > 1 && i < 2 * N - 3; ++i) {
      const auto side_of = [&](const Vector3d& p) { return turn(hull[i], hull[(i + 1) % N], p); };
      const int first = side_of(corners_[0]);
      if (first != 0 && first == side_of(corners_[1]) && first == side_of(corners_[2]) &&
          (N == 2 || first != side_of(hull[(i + 2) % N])))
        return true;
    }
    return false;
  }

  const std::array<Vector3d, 3>& corners() const { return corners_; }

private:
  Vector2d flat(const Vector3d& p) const { return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]}; }

  std::array<Vector3d, 3> corners_;
  int axis_ = 0;  ///< along which the triangle has an area, if it has one
  int turn_ = 0;  ///< sign of that area
};

/// A corner of a triangle, and the sign of the side of another triangle's plane that it is on.
struct SidedCorner {
  Vector3d at;
  int side;
};

/// Whether a closed segment and a closed triangle have a point in common.
bool segmentMeets(const SidedCorner& p, const SidedCorner& q, const ExactTriangle& t) {
  if (p.side * q.side > 0)
    return false;
  if (p.side == 0 && q.side == 0)
    return !t.isApart(std::array{p.at, q.at});
  if (p.side == 0 || q.side == 0)
    return !t.isApart(std::array{p.side == 0 ? p.at : q.at});
  const auto& [a, b, c] = t.corners();
  const int first = orientation3d(p.at, q.at, a, b);
  const int second = orientation3d(p.at, q.at, b, c);
  const int third = orientation3d(p.at, q.at, c, a);
  return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
}

}  // namespace

bool intersectExactly(const Face& face_a, const Face& face_b) {
  std::array<Vector3d, 3> of_a = face_a.corners;
  std::array<Vector3d, 3> of_b = face_b.corners;
  // Brings common corners to the front, in the same order.
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = common; j < 3; ++j)
      if (of_a[i] == of_b[j]) {
        std::swap(of_a[i], of_a[common]);
        std::swap(of_b[j], of_b[common]);
        ++common;
        break;
      }
  const ExactTriangle a(of_a);
  const ExactTriangle b(of_b);
  if (!a.hasArea() || !b.hasArea())
    return false;
  if (common == 3)
    return true;
  if (common == 0 && a.isApart(of_b))  // cheap, and true for most pairs of a flat mesh
    return false;
  if (common == 2)  // The cheap test first: in a flat mesh, neighbours lie on different sides.
    return a.turn(of_a[0], of_a[1], of_a[2]) * a.turn(of_a[0], of_a[1], of_b[2]) > 0 &&
           a.side(of_b[2]) == 0;
  std::array<int, 3> a_sides{};
  std::array<int, 3> b_sides{};
  for (std::size_t i = common; i < 3; ++i) {
    a_sides[i] = b.side(of_a[i]);
    b_sides[i] = a.side(of_b[i]);
  }
  if (common == 0 && b_sides == std::array{0, 0, 0})
    return true;
  // If two triangles meet, a side of one of them meets the other. With a common corner, it is the
  // side opposite to that.
  for (std::size_t i = common; i < 3 - common; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (segmentMeets({of_a[i], a_sides[i]}, {of_a[next], a_sides[next]}, b) ||
        segmentMeets({of_b[i], b_sides[i]}, {of_b[next], b_sides[next]}, a))
      return true;
  }
  return false;
}

}  // namespace spherical_param::internal
