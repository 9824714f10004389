#include "spherical_param/point_set.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

namespace spherical_param {
namespace {

using test::randomSphere;

TEST(PointSet, EachPlaceIsItsFirstPoint) {
  Positions points(3, 6);
  points << 1, 2, 1, 0, -0.0, 2,  //
      1, 2, 1, 0, 0, 2,           //
      1, 2, 1, 0, 0, 3;
  const DistinctPoints distinct = findDistinctPoints(points);
  const std::vector<Index> vertices{0, 1, 0, 2, 2, 3};
  const std::vector<Index> inputs{0, 1, 3, 5};
  EXPECT_EQ(distinct.vertex_of_input, vertices);
  EXPECT_EQ(distinct.input_of_vertex, inputs);
}

TEST(PointSet, AgreesWithBruteForceOnAGridOfRepetitions) {
  Positions points = (randomSphere(400, 1) * 3.0).array().round();
  const DistinctPoints distinct = findDistinctPoints(points);
  std::vector<Index> first;
  for (Index i = 0; i < points.cols(); ++i) {
    Index j = 0;
    while (points.col(j) != points.col(i))
      ++j;
    if (j == i)
      first.push_back(i);
    EXPECT_EQ(distinct.input_of_vertex[static_cast<std::size_t>(
                  distinct.vertex_of_input[static_cast<std::size_t>(i)])],
              j);
  }
  EXPECT_EQ(distinct.input_of_vertex, first);
}

TEST(PointSet, NonFinitePointIsInvalidInput) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Positions points = randomSphere(10, 2);
    points(1, 7) = bad;
    EXPECT_THROW(findDistinctPoints(points), InvalidInput);
  }
}

TEST(PointSet, NoPointsAreNoVertices) {
  EXPECT_TRUE(findDistinctPoints(Positions(3, 0)).input_of_vertex.empty());
}

TEST(PointSet, PlanesAreFoundExactly) {
  Positions points = randomSphere(200, 3);
  EXPECT_FALSE(areCoplanar(points));
  points.row(2).setConstant(0.1);
  EXPECT_TRUE(areCoplanar(points));
  points(2, 77) = std::nextafter(0.1, 1.0);  // one bit off the plane
  EXPECT_FALSE(areCoplanar(points));
}

TEST(PointSet, TiltedPlaneOfExactCoordinatesIsCoplanar) {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<int> integer(-1000, 1000);
  Positions points(3, 300);
  for (Index i = 0; i < points.cols(); ++i) {
    const double x = integer(random);
    const double y = integer(random);
    points.col(i) << x / 1024.0, y / 1024.0, (3.0 * x - 7.0 * y) / 1024.0;
  }
  EXPECT_TRUE(areCoplanar(points));
  points(2, 150) += std::ldexp(1.0, -45);
  EXPECT_FALSE(areCoplanar(points));
}

TEST(PointSet, LinesAndPointsAreCoplanar) {
  Positions line(3, 50);
  for (Index i = 0; i < 50; ++i)
    line.col(i) = Eigen::Vector3d(1, 2, 4) * i;
  EXPECT_TRUE(areCoplanar(line));
  EXPECT_TRUE(areCoplanar(Positions::Constant(3, 50, 0.3)));
  EXPECT_TRUE(areCoplanar(randomSphere(3, 5)));
  // Two points beside the line in different directions span space.
  line(0, 10) = std::nextafter(line(0, 10), 100.0);
  EXPECT_TRUE(areCoplanar(line));
  line(1, 20) = std::nextafter(line(1, 20), 100.0);
  EXPECT_FALSE(areCoplanar(line));
}

// Products of differences leave the range of double: plain evaluation sees planes that are none.
TEST(PointSet, PlanesAreFoundExactlyWhateverTheMagnitudes) {
  const double d = std::numeric_limits<double>::denorm_min();
  const double m = std::numeric_limits<double>::max();
  const auto are_coplanar = [](std::initializer_list<Eigen::Vector3d> places) {
    Positions points(3, static_cast<Eigen::Index>(places.size()));
    Eigen::Index i = 0;
    for (const Eigen::Vector3d& place : places)
      points.col(i++) = place;
    return areCoplanar(points);
  };
  for (const double tiny : {1e-100, 1e-120, 1e-200, d}) {
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, 1}})) << tiny;
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}})) << tiny;
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {tiny, 0, 0}, {0, tiny, 0}})) << tiny;
    EXPECT_FALSE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, tiny}, {0, tiny, 1}}));
    EXPECT_TRUE(are_coplanar({{0, 0, 0}, {1, 1, 1}, {tiny, tiny, 0}, {3, 3, tiny}})) << tiny;
    EXPECT_TRUE(are_coplanar({{tiny, 0, 0}, {tiny, 1, 0}, {tiny, 0, 1}, {tiny, m, -m}})) << tiny;
    EXPECT_TRUE(are_coplanar({{0, 0, 0}, {tiny, tiny, tiny}, {1, 1, 1}, {m, m, m}})) << tiny;
  }
  EXPECT_FALSE(are_coplanar({{m, 0, 0}, {-m, 0, 0}, {0, m, 0}, {0, 0, d}}));
  EXPECT_FALSE(are_coplanar({{m, m, m}, {-m, -m, -m}, {m, -m, m}, {m, -m, -m}}));
  EXPECT_TRUE(are_coplanar({{m, m, m}, {-m, m, -m}, {m, -m, m}, {-m, -m, -m}}));
}

TEST(PointSet, CoplanarityAndOrderOfNonFinitePointsAreInvalidInput) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Positions points = test::randomSphere(5, 1);
    points(1, 3) = bad;
    EXPECT_THROW(areCoplanar(points), InvalidInput);
    EXPECT_THROW(spatialOrder(points), InvalidInput);
  }
}

// Products of three coordinates underflow here; the plane is still that of the doubles.
TEST(PointSet, PlanesOfTinyDifferencesAreFoundExactly) {
  for (const double tiny : {0x1p-300, 0x1p-365, 0x1p-660, 0x1p-1000, 0x1p-1074}) {
    Positions points(3, 5);
    points << 0, 1, 0, 0, 0.5,    //
        0, 0, tiny, 0, 3 * tiny,  //
        0, 0, 0, tiny, 0;
    EXPECT_FALSE(areCoplanar(points)) << tiny;
    points(2, 3) = 0.0;
    EXPECT_TRUE(areCoplanar(points)) << tiny;
    // The plane z = x + y, which no axis hides.
    points << 0, 1, 0, 7 * tiny, tiny,   //
        0, 0, tiny, 2 * tiny, 3 * tiny,  //
        0, 1, tiny, 9 * tiny, 4 * tiny;
    EXPECT_TRUE(areCoplanar(points)) << tiny;
    points(2, 4) = 5 * tiny;
    EXPECT_FALSE(areCoplanar(points)) << tiny;
    // All of it so small, or large.
    points << 0, tiny, 0, 0, tiny,  //
        0, 0, tiny, 0, tiny,        //
        0, 0, 0, tiny, tiny;
    EXPECT_FALSE(areCoplanar(points)) << tiny;
    EXPECT_FALSE(areCoplanar(points / tiny * 1e250)) << tiny;
  }
}

TEST(SpatialOrder, HoldsEveryPointOnceAndNeighborsNearEachOther) {
  const Positions points = test::randomSphere(5000, 3);
  const std::vector<Index> order = spatialOrder(points);
  std::vector<Index> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  double length = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    ASSERT_EQ(sorted[i], static_cast<Index>(i));
    if (i > 0)
      length += (points.col(order[i]) - points.col(order[i - 1])).norm();
  }
  // Points are 0.05 apart; from one to any other it is 1.3 on average.
  EXPECT_LT(length / 5000.0, 0.15);
  EXPECT_TRUE(spatialOrder(Positions(3, 0)).empty());
}

}  // namespace
}  // namespace spherical_param
