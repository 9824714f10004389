#include "core/exact_predicates.h"

#include <gtest/gtest.h>

#include <cmath>

namespace spherical_param::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(ExactPredicates, SignsOfPlainCases) {
  EXPECT_EQ(orientation2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orientation2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orientation2d({0, 0}, {1, 1}, {3, 3}), 0);
  EXPECT_EQ(orientation3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orientation3d({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
  EXPECT_EQ(orientation3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, -3, 0}), 0);
}

// The grid of neighbouring doubles around a point on the line y = x: the sign is that of the
// integers, which plain evaluation gets wrong for most of the grid (Kettner et al. 2008).
TEST(ExactPredicates, OrientationInThePlaneIsExactOnNeighbouringDoubles) {
  const double step = std::ldexp(1.0, -53);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vector2d p(0.5 + i * step, 0.5 + j * step);
      const int expected = (j > i) - (j < i);
      EXPECT_EQ(orientation2d({12.0, 12.0}, {24.0, 24.0}, p), expected) << i << " " << j;
    }
}

// The same in space: on the plane z = x + y, tilted so that no product is exact.
TEST(ExactPredicates, OrientationInSpaceIsExactOnNeighbouringDoubles) {
  const double step = std::ldexp(1.0, -52);
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 24; ++j)
      for (int k = 0; k < 24; ++k) {
        const Vector3d p(0.5 + i * step, 0.25 + j * step, 0.75 + k * step);
        const int expected = (k > i + j) - (k < i + j);
        EXPECT_EQ(orientation3d({0.0, 0.0, 0.0}, {13.0, 1.0, 14.0}, {1.0, 13.0, 14.0}, p), expected)
            << i << " " << j << " " << k;
      }
}

TEST(ExactPredicates, SwappingTwoPointsTurnsTheSign) {
  const double step = std::ldexp(1.0, -50);
  const Vector3d a(0.1, 0.2, 0.3);
  const Vector3d b(0.7, 0.1, 0.4);
  const Vector3d c(0.3, 0.9, 0.6);
  const Vector3d inside = (a + b + c) / 3.0;
  for (int i = -20; i <= 20; ++i) {
    const Vector3d d = inside + Vector3d(i * step, -i * step, i * step / 2.0);
    EXPECT_EQ(orientation3d(a, b, c, d), -orientation3d(b, a, c, d));
    EXPECT_EQ(orientation3d(a, b, c, d), -orientation3d(a, b, d, c));
    EXPECT_EQ(orientation3d(a, b, c, d), orientation3d(b, c, a, d));
  }
}

}  // namespace
}  // namespace spherical_param::internal
