#include "space_filling_curve.h"

#include "helpers.h"
#include "ordered_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

bool isPermutation(std::vector<Index> order, Index n) {
  std::sort(order.begin(), order.end());
  std::vector<Index> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), Index{0});
  return order == all;
}

/// Length of the way through the last `count` points of an order.
double wayLength(const Positions& points, const std::vector<Index>& order, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = order.size() - count + 1; i < order.size(); ++i)
    sum += (points.col(order[i]) - points.col(order[i - 1])).norm();
  return sum;
}

TEST(SpaceFillingCurve, OrdersArePermutations) {
  for (const Index n : {0, 1, 2, 100, 5000}) {
    const Positions points = test::randomSphere(n, 1);
    EXPECT_TRUE(isPermutation(mortonOrder(points), n));
    EXPECT_TRUE(isPermutation(insertionOrder(points), n));
  }
  const Positions repeated = test::randomSphere(1, 1).replicate(1, 3000);
  EXPECT_TRUE(isPermutation(mortonOrder(repeated), 3000));
  EXPECT_TRUE(isPermutation(insertionOrder(repeated), 3000));
}

TEST(SpaceFillingCurve, MortonOrderIsTheSameForAnyScale) {
  // Whole numbers: no scale rounds them, and the least are denormal.
  std::mt19937_64 random(1);
  Positions points(3, 1000);
  for (Eigen::Index i = 0; i < points.size(); ++i)
    points.data()[i] = static_cast<double>(random() % 1024) - 512.0;
  const std::vector<Index> order = mortonOrder(points);
  for (const double scale :
       {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::min(), 0x1p-300,
        0x1p300, 0x1p1000, 0x1p1014}) {
    EXPECT_EQ(mortonOrder(points * scale), order) << scale;
    EXPECT_EQ(orderPoints(points * scale, 1).input_of_node, orderPoints(points, 1).input_of_node);
  }
}

TEST(SpaceFillingCurve, AnAxisFarAwayChangesNothing) {
  Positions points = 1e-300 * test::randomSphere(100, 1);
  points.row(1).setZero();
  const std::vector<Index> order = mortonOrder(points);
  points.row(1).setConstant(1e300);
  EXPECT_EQ(mortonOrder(points), order);
  EXPECT_TRUE(orderPoints(points, 1).points.allFinite());
}

// The last round has 7 of 8 points; on average, one is about a mean spacing from the one before.
TEST(SpaceFillingCurve, MortonOrderIsThatOfSortedKeys) {
  for (const Index n : {100, 5000}) {
    Positions points = test::randomSphere(n, 4);
    points.row(1) *= 0.25;
    points.rightCols(n / 4) = points.leftCols(n / 4).eval();  // ties
    const Eigen::Vector3d low = points.rowwise().minCoeff();
    const double scale = 2097151.0 / (points.rowwise().maxCoeff() - low).maxCoeff();
    std::vector<std::pair<std::uint64_t, Index>> keys;
    for (Index i = 0; i < n; ++i) {
      const Eigen::Vector3d cell = (points.col(i) - low) * scale;
      std::uint64_t key = 0;
      for (unsigned bit = 0; bit < 21; ++bit)
        for (unsigned axis = 0; axis < 3; ++axis)
          key |= (static_cast<std::uint64_t>(cell[axis]) >> bit & 1U) << (3 * bit + axis);
      keys.emplace_back(key, i);
    }
    std::sort(keys.begin(), keys.end());
    const std::vector<Index> order = mortonOrder(points);
    ASSERT_EQ(order.size(), keys.size());
    for (std::size_t k = 0; k < keys.size(); ++k)
      EXPECT_EQ(order[k], keys[k].second);
  }
}

TEST(SpaceFillingCurve, LastRoundGoesFromPointToNearPoint) {
  for (const Index n : {2000, 100000}) {
    const Positions points = test::randomSphere(n, 2);
    const auto count = static_cast<std::size_t>(n) * 3 / 4;
    const double spacing = std::sqrt(4.0 * test::kPi / n);
    EXPECT_LT(wayLength(points, insertionOrder(points), count),
              1.5 * spacing * static_cast<double>(count));
  }
}

// Also in a cap that is smaller than the cells of the curve.
TEST(SpaceFillingCurve, CrowdsAreOrderedToo) {
  const Index n = 20000;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const double radius : {1e-6, 1e-12}) {
    Positions points(3, n);
    for (Index i = 0; i < n; ++i)
      points.col(i) = Eigen::Vector3d(0.6 + radius * uniform(random), radius * uniform(random), 0.8)
                          .normalized();
    const auto count = static_cast<std::size_t>(n) * 3 / 4;
    const double spacing = 2.0 * radius / std::sqrt(n);
    EXPECT_LT(wayLength(points, insertionOrder(points), count),
              1.5 * spacing * static_cast<double>(count));
  }
}

// Every round is a sample of the whole: the first points lie all over the sphere.
TEST(SpaceFillingCurve, FirstRoundsAreSpreadOverTheSphere) {
  const Positions points = test::randomSphere(100000, 4);
  const std::vector<Index> order = insertionOrder(points);
  Eigen::Vector3d low = points.col(order[0]);
  Eigen::Vector3d high = low;
  for (std::size_t i = 0; i < 300; ++i) {
    low = low.cwiseMin(points.col(order[i]));
    high = high.cwiseMax(points.col(order[i]));
  }
  EXPECT_LT(low.maxCoeff(), -0.8);
  EXPECT_GT(high.minCoeff(), 0.8);
}

}  // namespace
}  // namespace spherical_param::internal
