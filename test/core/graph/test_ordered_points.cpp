#include "ordered_points.h"

#include "helpers.h"
#include "radix_sort.h"
#include "reference/distinct_points.h"
#include "space_filling_curve.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>

namespace spherical_param::internal {
namespace {

void expectTheSameAsTwoSteps(const Positions& points, int threads) {
  const OrderedPoints ordered = orderPoints(points, threads);
  const reference::OrderedPoints expected = reference::orderPoints(points, ordered.exponent);
  const DistinctPoints& distinct = expected.distinct;
  EXPECT_EQ(ordered.distinct.vertex_of_input, distinct.vertex_of_input);
  EXPECT_EQ(ordered.distinct.input_of_vertex, distinct.input_of_vertex);
  EXPECT_EQ(ordered.vertex_of_node, expected.vertex_of_node);
  EXPECT_EQ(ordered.points, expected.points);
  const Positions vertices = points(Eigen::all, distinct.input_of_vertex);
  EXPECT_EQ(ordered.vertex_of_node, mortonOrder(vertices * std::ldexp(1.0, -ordered.exponent)));
  for (std::size_t node = 0; node < ordered.input_of_node.size(); ++node)
    EXPECT_EQ(ordered.input_of_node[node],
              distinct.input_of_vertex[static_cast<std::size_t>(ordered.vertex_of_node[node])]);
}

TEST(OrderedPoints, AreTheDistinctPointsAlongTheCurve) {
  for (const Index n : {1, 2, 100, 3000})
    expectTheSameAsTwoSteps(7.0 * test::randomSphere(n, 1), 1);
}

TEST(OrderedPoints, AreTheSameForAnyNumberOfThreads) {
  const Positions points = test::randomSphere(60000, 2);
  for (const int threads : {1, 2, 3})
    expectTheSameAsTwoSteps(points, threads);
}

TEST(OrderedPoints, RepetitionsAreFoundWhereverTheyAre) {
  const Index n = 2000;
  std::mt19937_64 random(3);
  Positions points = test::randomSphere(n, 3);
  for (Index i = n / 2; i < n; ++i)
    points.col(i) = points.col(static_cast<Index>(random() % (n / 2)));
  expectTheSameAsTwoSteps(points, 1);
  expectTheSameAsTwoSteps(test::randomSphere(4, 1).replicate(1, 500), 1);
}

TEST(OrderedPoints, ZerosOfBothSignsAreTheSame) {
  Positions points(3, 4);
  points << 0.0, -0.0, 1.0, 0.0,  //
      0.0, 0.0, 0.0, 1.0,         //
      -0.0, 0.0, 0.0, 0.0;
  EXPECT_EQ(orderPoints(points, 1).distinct.vertex_of_input, (std::vector<Index>{0, 0, 1, 2}));
}

// Many points in one cell of the curve, which has 2^21 an axis: apart, and some of them twice.
TEST(OrderedPoints, CrowdsInOneCellStayApart) {
  Positions points(3, 1002);
  for (Eigen::Index i = 0; i < 1000; ++i)
    points.col(i) = Eigen::Vector3d(1e-12 * static_cast<double>((i * 7) % 900), 0.0, 1e-13);
  points.col(1000) = Eigen::Vector3d(1.0, 1.0, 1.0);
  points.col(1001) = Eigen::Vector3d(0.0, 1.0, 0.5);
  expectTheSameAsTwoSteps(points, 1);
  EXPECT_EQ(orderPoints(points, 1).input_of_node.size(), 902U);
}

TEST(OrderedPoints, AreOfExtentOneAtAnyScale) {
  for (const double scale : {1e-300, 1e-30, 1.0, 1e30, 1e100}) {
    const OrderedPoints ordered = orderPoints(scale * test::randomSphere(500, 4), 1);
    EXPECT_EQ(ordered.points.cols(), 500);
    EXPECT_LE(ordered.points.cwiseAbs().maxCoeff(), 1.1);
    EXPECT_GE(ordered.points.cwiseAbs().maxCoeff(), 0.4);
  }
}

struct Item {
  std::uint64_t key;
  int place;
};

TEST(RadixSort, SortsKeysOfAnyLengthStably) {
  std::mt19937_64 random(5);
  for (const int bits : {0, 3, 11, 12, 33, 63, 64}) {
    const std::uint64_t mask =
        bits == 0 ? 0 : std::numeric_limits<std::uint64_t>::max() >> (64 - bits);
    std::vector<Item> items;
    for (int i = 0; i < 3000; ++i)
      items.push_back({random() & mask, i});
    std::vector<Item> expected = items;
    std::stable_sort(expected.begin(), expected.end(),
                     [](const Item& a, const Item& b) { return a.key < b.key; });
    radixSort(items);
    for (std::size_t i = 0; i < items.size(); ++i)
      ASSERT_EQ(items[i].place, expected[i].place) << bits << " bits";
  }
  std::vector<Item> none;
  radixSort(none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace spherical_param::internal
