#include "exact_predicates.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

__extension__ using Wide = __int128;

int signOf(Wide x) {
  return (x > 0) - (x < 0);
}

// The grid of neighbouring doubles around a point on the line y = x: the sign is that of the
// integers, which plain evaluation gets wrong for most of the grid (Kettner et al. 2008).
TEST(ExactPredicates, OrientationInThePlaneIsExactOnNeighbouringDoubles) {
  const Vector2d a(12.0, 12.0);
  const Vector2d b(24.0, 24.0);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vector2d p(0.5 + std::ldexp(i, -53), 0.5 + std::ldexp(j, -53));
      ASSERT_EQ(orientation2d(a, b, p), signOf(j - i)) << i << " " << j;
      ASSERT_EQ(orientation2d(p, a, b), signOf(j - i)) << i << " " << j;
      ASSERT_EQ(orientation2d(b, a, p), signOf(i - j)) << i << " " << j;
    }
}

// The circle about (65, 0) of radius 65 through 8 integer points and the origin; d lies near the
// origin, far below the last digit of the others: not even the differences fit into doubles.
TEST(ExactPredicates, InCircleIsExactWhereDifferencesAreNot) {
  const std::array<Vector2d, 8> circle{
      {{81, 63}, {98, 56}, {90, 60}, {104, 52}, {81, -63}, {40, 60}, {26, -52}, {130, 0}}};
  std::mt19937_64 random(6);
  std::uniform_int_distribution<std::int64_t> mantissa(1, std::int64_t{1} << 37);
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t y = mantissa(random);
    // In units of 2^-60: |d - (65, 0)|^2 - 65^2 = x^2 - 130 2^60 x + y^2.
    const double square = static_cast<double>(y) * static_cast<double>(y);
    const auto tie = static_cast<std::int64_t>(std::ldexp(square / 130.0, -60));
    for (std::int64_t x = std::max<std::int64_t>(tie - 2, 0); x <= tie + 2; ++x) {
      const Wide beyond =
          static_cast<Wide>(x) * x - (static_cast<Wide>(130 * x) << 60) + static_cast<Wide>(y) * y;
      const Vector2d d(std::ldexp(static_cast<double>(x), -60),
                       std::ldexp(static_cast<double>(y), -60));
      for (std::size_t k = 0; k < circle.size(); ++k) {
        const Vector2d& a = circle[k];
        const Vector2d& b = circle[(k + 1) % circle.size()];
        const Vector2d& c = circle[(k + 3) % circle.size()];
        ASSERT_EQ(exactInCircle(a, b, c, d), -signOf(beyond) * orientation2d(a, b, c));
        ASSERT_EQ(inCircle(a, b, c, d), exactInCircle(a, b, c, d));
      }
    }
  }
}

// The filter only saves time. Beyond the range of products, all is exact, too.
TEST(ExactPredicates, AllEvaluationsAgreeAtEveryScale) {
  std::mt19937_64 random(9);
  std::uniform_int_distribution<int> few(-2, 2);
  std::normal_distribution<double> real;
  for (int i = 0; i < 400; ++i) {
    const auto point = [&] {
      return i % 2 == 0 ? Vector3d(few(random), few(random), few(random))
                        : Vector3d(real(random), real(random), real(random));
    };
    const Vector3d a = point();
    const Vector3d b = point();
    const Vector3d c = point();
    const Vector3d d = i % 3 == 0 ? Vector3d(a + 2.0 * (b - a) - (c - a)) : point();
    const int flat = orientation2d(a.head<2>(), b.head<2>(), c.head<2>());
    const int solid = orientation3d(a, b, c, d);
    ASSERT_EQ(exactOrientation2d(a.head<2>(), b.head<2>(), c.head<2>()), flat);
    ASSERT_EQ(exactOrientation3d(a, b, c, d), solid);
    ASSERT_EQ(exactInCircle(a.head<2>(), b.head<2>(), c.head<2>(), d.head<2>()),
              inCircle(a.head<2>(), b.head<2>(), c.head<2>(), d.head<2>()));
    // Scaling by powers of two is exact: the lowest bits stay above those of denormal numbers.
    for (const int exponent : {0, -900, 1000}) {
      const auto scaled = [&](const Vector3d& p) {
        return Vector3d(p.unaryExpr([&](double x) { return std::ldexp(x, exponent); }));
      };
      const Vector3d sa = scaled(a);
      const Vector3d sb = scaled(b);
      const Vector3d sc = scaled(c);
      ASSERT_EQ(orientation2d(sa.head<2>(), sb.head<2>(), sc.head<2>()), flat);
      ASSERT_EQ(orientation3d(sa, sb, sc, scaled(d)), solid);
    }
  }
}

Triangles turned(const Triangles& triangles) {
  return triangles(std::vector{1, 0, 2}, Eigen::all);
}

// The corner of a unit cube, thinner and thinner, far from the origin, and with a far outlier.
TEST(ExactPredicates, TheSignOfAVolumeIsExactHoweverSmallItIs) {
  const Triangles outward = test::tetrahedron();
  for (const double height : {1.0, 0x1p-40, 0x1p-300, 0x1p-1074})
    for (const double offset : {0.0, 0x1p20, 0x1p300}) {
      Positions points{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, height}};
      points.topRows(2).array() += offset;
      const int expected = offset < 0x1p50 ? 1 : 0;  // beyond, all are in one place
      EXPECT_EQ(volumeSign(points, outward), expected) << height << " " << offset;
      EXPECT_EQ(volumeSign(points, turned(outward)), -expected) << height << " " << offset;
    }
  // A fan around a line to a far point: large volumes that nearly cancel.
  const Positions points{{0, 1, 0, 0.25, 0x1p60}, {0, 0, 1, 0.25, 0x1p60}, {0, 0, 0, 0x1p-45, 0}};
  // The bipyramid over 0, 1, 2 with the tips 3 above and 4 in the plane: as 0, 1, 2, 3 is.
  const Triangles fan{{0, 1, 2, 1, 0, 2}, {1, 2, 0, 0, 2, 1}, {3, 3, 3, 4, 4, 4}};
  EXPECT_EQ(volumeSign(points, fan), 1);
  EXPECT_EQ(volumeSign(points, turned(fan)), -1);
  EXPECT_EQ(volumeSign(points, Triangles(3, 0)), 0);
}

TEST(Coplanarity, IsThatOfPlanesLinesAndPointsToTheLastBit) {
  Positions plane = test::randomSphere(200, 3);
  EXPECT_FALSE(areCoplanar(plane));
  plane.row(2).setConstant(0.1);
  EXPECT_TRUE(areCoplanar(plane));
  plane(2, 77) = std::nextafter(0.1, 1.0);
  EXPECT_FALSE(areCoplanar(plane));
  Positions line = Vector3d(1, 2, 4) * Eigen::RowVectorXd::LinSpaced(50, 0.0, 49.0);
  EXPECT_TRUE(areCoplanar(line));
  EXPECT_TRUE(areCoplanar(Positions::Constant(3, 50, 0.3)));
  EXPECT_TRUE(areCoplanar(test::randomSphere(3, 5)));
  // Two points beside the line in different directions span space.
  line(0, 10) = std::nextafter(line(0, 10), 100.0);
  EXPECT_TRUE(areCoplanar(line));
  line(1, 20) = std::nextafter(line(1, 20), 100.0);
  EXPECT_FALSE(areCoplanar(line));
}

// Products of differences leave the range of double: plain evaluation would find false planes.
TEST(Coplanarity, PlanesAreFoundExactlyWhateverTheMagnitudes) {
  const double m = std::numeric_limits<double>::max();
  const auto are_coplanar = [](const std::vector<Vector3d>& places) {
    return areCoplanar(test::positionsOf(places));
  };
  for (const double tiny : {1e-100, 1e-120, 1e-200, 0x1p-1074}) {
    SCOPED_TRACE(tiny);
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {tiny, 0, 0}, {0, tiny, 0}}));
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, tiny}, {0, tiny, 1}}));
    EXPECT_TRUE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {tiny, tiny, 0}, {3, 3, tiny}}));
    EXPECT_TRUE(are_coplanar({{tiny, 0, 0}, {tiny, 1, 0}, {tiny, 0, 1}, {tiny, m, -m}}));
    EXPECT_TRUE(are_coplanar({{0, 0, 0}, {tiny, tiny, tiny}, {1, 1, 1}, {m, m, m}}));
    EXPECT_FALSE(are_coplanar({{m, 0, 0}, {-m, 0, 0}, {0, m, 0}, {0, 0, tiny}}));
  }
  EXPECT_FALSE(are_coplanar({{m, m, m}, {-m, -m, -m}, {m, -m, m}, {m, -m, -m}}));
  EXPECT_TRUE(are_coplanar({{m, m, m}, {-m, m, -m}, {m, -m, m}, {-m, -m, -m}}));
}

// The same in space, on the plane z = x + y: not even differences from the first point are exact.
TEST(ExactPredicates, OrientationInSpaceIsExactOnNeighbouringDoublesAndWhereProductsUnderflow) {
  const Vector3d a(0.0, 0.0, 0.0);
  const Vector3d b(13.0, 1.0, 14.0);
  const Vector3d c(1.0, 13.0, 14.0);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      for (int k = 0; k < 24; ++k) {
        const Vector3d p(0.5 + std::ldexp(i, -52), 0.25 + std::ldexp(j, -52),
                         0.75 + std::ldexp(k, -52));
        ASSERT_EQ(orientation3d(a, b, c, p), signOf(k - i - j)) << i << " " << j << " " << k;
        ASSERT_EQ(orientation3d(p, b, c, a), signOf(i + j - k)) << i << " " << j << " " << k;
      }
  const double least = std::numeric_limits<double>::denorm_min();
  const Vector3d u(0.1, 0.7, 0.3);
  const Vector3d v(-0.4, 0.6, -0.2);
  for (const double x : {-least, 0.0, least}) {
    const int expected = (x < 0.0) - (x > 0.0);  // of x (0.7 * -0.2 - 0.3 * 0.6)
    EXPECT_EQ(orientation3d(a, u, v, {x, 0.0, 0.0}), expected);
    EXPECT_EQ(orientation3d({x, 0.0, 0.0}, u, a, v), expected);
    EXPECT_EQ(orientation2d({0.0, 0.0}, u.head<2>(), {x, 0.0}), expected);
  }
}

}  // namespace
}  // namespace spherical_param::internal
