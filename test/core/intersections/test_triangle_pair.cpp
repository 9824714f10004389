#include "triangle_pair.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

/// Whether two triangles, given by their corners, intersect.
bool meet(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  const Positions points = horizontally(positionsOf(a), positionsOf(b));
  std::array<Index, 3> corners{3, 4, 5};
  const auto intersects = [&] {
    const Face of_a = internal::faceOf(points, 0x1p-70, {0, 1, 2}, 0);
    const Face of_b = internal::faceOf(points, 0x1p-70, corners, 1);
    EXPECT_EQ(intersect(of_b, of_a), intersect(of_a, of_b));
    EXPECT_EQ(intersectExactly(of_a, of_b), intersect(of_a, of_b));
    return intersect(of_a, of_b);
  };
  const bool result = intersects();
  // The same if they share the numbers of the vertices that are equal.
  for (Index& corner : corners)
    for (Index i = 0; i < 3; ++i)
      if (points.col(i) == points.col(corner))
        corner = i;
  EXPECT_EQ(intersects(), result);
  return result;
}

// A corner on a grid of neighbouring doubles around the plane z = x + y, tilted so that no product
// is exact: plain evaluation mistakes most of the grid.
TEST(TrianglePair, NeighbouringDoublesAreDistinguished) {
  const double step = std::ldexp(1.0, -52);
  const Eigen::Vector3d a(13, 1, 14);
  const Eigen::Vector3d b(1, 13, 14);
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 24; ++k) {
        const Eigen::Vector3d p(0.5 + i * step, 0.25 + j * step, 0.75 + k * step);
        ASSERT_EQ(meet({a, b, zero}, {b, a, p}), k == i + j);  // folded
        ASSERT_EQ(meet({a, b, zero}, {p, {1, 1, 20}, {2, 1, 20}}), k <= i + j);
        ASSERT_EQ(meet({a, b, zero}, {a, p, {12, 1, 20}}), k <= i + j);
      }
}

// A triangle that touches another one besides their common vertex, or without one, and a direction
// between the two that is normal to where they touch: rounded off, it seems to separate them.
TEST(TrianglePair, RoundingSeparatesNothing) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> coordinate(-10000, 10000);
  const auto next = [&] {
    const double x = coordinate(random);
    const double y = coordinate(random);
    return Eigen::Vector3d(x, y, coordinate(random));
  };
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d along = 12.0 * 4097.0 * next();
    const Eigen::Vector3d across = next().cross(along);
    const Eigen::Vector3d a = across + along / 12.0 * (i % 5);
    // The sums of the differences of their corners are multiples of `across`.
    const Eigen::Vector3d b = along / 12.0 * 7.0;
    ASSERT_TRUE(meet({{0, 0, 0}, along, a}, {{0, 0, 0}, b, a + along / 12.0 * 5.0 - 3.0 * across}));
    ASSERT_TRUE(meet({-along, along, a}, {b, b - across, a - 2.0 * b - 2.0 * across}));
  }
}

}  // namespace
}  // namespace spherical_param::test
