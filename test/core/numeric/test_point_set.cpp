#include "point_set.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(PointSet, OneBitOffAPlaneIsNotCoplanar) {
  Positions points = randomSphere(200, 3);
  EXPECT_FALSE(areCoplanar(points));
  points.row(2).setConstant(0.1);
  EXPECT_TRUE(areCoplanar(points));
  points(2, 77) = std::nextafter(0.1, 1.0);
  EXPECT_FALSE(areCoplanar(points));
}

TEST(PointSet, LinesAndPointsAreCoplanar) {
  Positions line = Eigen::Vector3d(1, 2, 4) * Eigen::RowVectorXd::LinSpaced(50, 0.0, 49.0);
  EXPECT_TRUE(areCoplanar(line));
  EXPECT_TRUE(areCoplanar(Positions::Constant(3, 50, 0.3)));
  EXPECT_TRUE(areCoplanar(randomSphere(3, 5)));
  // Two points beside the line in different directions span space.
  line(0, 10) = std::nextafter(line(0, 10), 100.0);
  EXPECT_TRUE(areCoplanar(line));
  line(1, 20) = std::nextafter(line(1, 20), 100.0);
  EXPECT_FALSE(areCoplanar(line));
}

/// Whether integers of few digits lie in one plane.
bool liesInPlane(const Eigen::Matrix<int, 3, 5>& p) {
  for (int i = 1; i < 5; ++i)
    for (int j = 1; j < i; ++j)
      for (int k = 1; k < j; ++k) {
        Eigen::Matrix3i rows;
        rows << p.col(i) - p.col(0), p.col(j) - p.col(0), p.col(k) - p.col(0);
        if (rows.determinant() != 0)
          return false;
      }
  return true;
}

// Products of differences leave the range of double: plain evaluation sees planes that are none.
TEST(PointSet, PlanesAreFoundExactlyWhateverTheMagnitudes) {
  std::mt19937_64 random(6);
  std::uniform_int_distribution<int> integer(-2, 2);
  const std::vector<double> scales{0x1p-1074, 0x1p-660, 0x1p-300, 1.0, 0x1p60, 0x1p500, 0x1p1000};
  int flat = 0;
  for (int round = 0; round < 500; ++round) {
    Eigen::Matrix<int, 3, 5> places;
    for (int i = 0; i < places.size(); ++i)
      places.data()[i] = integer(random);
    if (round % 2 == 0)
      places.row(2) = places.row(0) - 2 * places.row(1);
    Positions points = places.cast<double>();
    for (int axis = 0; axis < 3; ++axis)
      points.row(axis) *= scales[random() % scales.size()];
    EXPECT_EQ(areCoplanar(points), liesInPlane(places));
    flat += liesInPlane(places) ? 1 : 0;
  }
  EXPECT_LT(flat, 400);
}

TEST(PointSet, PlanesOfTinyDifferencesBesideLargeOnesAreFoundExactly) {
  const double m = std::numeric_limits<double>::max();
  const auto are_coplanar = [](const std::vector<Eigen::Vector3d>& places) {
    return areCoplanar(positionsOf(places));
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

}  // namespace
}  // namespace spherical_param::test
