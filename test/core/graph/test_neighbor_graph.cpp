#include "spherical_param/neighbor_graph.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <gtest/gtest.h>

#include <set>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::horizontally;
using test::randomSphere;

std::set<std::pair<Index, Index>> edgesOf(const Graph& graph) {
  std::set<std::pair<Index, Index>> edges;
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      edges.insert({static_cast<Index>(i), graph.neighbors[e]});
  return edges;
}

Index countReachable(const Graph& graph) {
  std::vector<bool> seen(graph.size(), false);
  std::vector<std::size_t> stack{0};
  seen[0] = true;
  Index count = 0;
  while (!stack.empty()) {
    const std::size_t i = stack.back();
    stack.pop_back();
    ++count;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(graph.neighbors[e]);
      if (!seen[j]) {
        seen[j] = true;
        stack.push_back(j);
      }
    }
  }
  return count;
}

/// Total length of the minimum spanning tree over the components (Prim on all pairs).
double shortestJoin(const Positions& points, const std::vector<Index>& component, Index count) {
  std::vector<bool> in_tree(static_cast<std::size_t>(count), false);
  in_tree[0] = true;
  double total = 0.0;
  for (Index step = 1; step < count; ++step) {
    double best = 1e300;
    std::size_t next = 0;
    for (Index i = 0; i < points.cols(); ++i)
      for (Index j = 0; j < points.cols(); ++j) {
        const auto ci = static_cast<std::size_t>(component[static_cast<std::size_t>(i)]);
        const auto cj = static_cast<std::size_t>(component[static_cast<std::size_t>(j)]);
        const double length = (points.col(i) - points.col(j)).norm();
        if (in_tree[ci] && !in_tree[cj] && length < best) {
          best = length;
          next = cj;
        }
      }
    in_tree[next] = true;
    total += best;
  }
  return total;
}

TEST(NeighborGraph, HoldsExactlyTheNearestNeighboursOfEitherEnd) {
  const Positions points = randomSphere(300, 1);
  const int k = 7;
  const NeighborLists lists = bruteForceNeighbors(points, k);
  std::set<std::pair<Index, Index>> expected;
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e) {
      expected.insert({static_cast<Index>(i), lists.indices[e]});
      expected.insert({lists.indices[e], static_cast<Index>(i)});
    }
  const NeighborGraph result = buildNeighborGraph(points, lists, test::nearest(k));
  EXPECT_EQ(result.report.components, 1);
  EXPECT_TRUE(result.report.bridges.empty());
  EXPECT_EQ(edgesOf(result.graph), expected);
  EXPECT_EQ(result.graph.neighbors.size(), expected.size());
}

TEST(NeighborGraph, LengthsAreDistancesAndRowsAreSorted) {
  const Positions points = randomSphere(200, 2);
  const Graph graph =
      buildNeighborGraph(points, bruteForceNeighbors(points, 6), test::nearest(6)).graph;
  ASSERT_EQ(graph.lengths.size(), graph.neighbors.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      EXPECT_DOUBLE_EQ(graph.lengths[e],
                       (points.col(static_cast<Index>(i)) - points.col(graph.neighbors[e])).norm());
      if (e > graph.offsets[i]) {
        EXPECT_LT(graph.neighbors[e - 1], graph.neighbors[e]);
      }
    }
}

TEST(NeighborGraph, ListsMayBeUnsortedLongerAndHoldThePointItself) {
  const Positions points = randomSphere(150, 3);
  const NeighborLists lists = bruteForceNeighbors(points, 20);
  NeighborLists messy;
  std::mt19937_64 random(7);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const auto begin = messy.indices.size();
    messy.indices.push_back(static_cast<Index>(i));
    messy.indices.insert(messy.indices.end(),
                         lists.indices.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i]),
                         lists.indices.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i + 1]));
    messy.indices.push_back(messy.indices[begin + 1]);  // repeated
    std::shuffle(messy.indices.begin() + static_cast<std::ptrdiff_t>(begin), messy.indices.end(),
                 random);
    messy.offsets.push_back(messy.indices.size());
  }
  EXPECT_EQ(
      edgesOf(buildNeighborGraph(points, messy, test::nearest(5)).graph),
      edgesOf(buildNeighborGraph(points, bruteForceNeighbors(points, 5), test::nearest(5)).graph));
}

TEST(NeighborGraph, PiecesAreJoinedByTheirMinimumSpanningTree) {
  Positions points(3, 0);
  std::vector<Index> component;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-20.0, 20.0);
  const Index pieces = 9;
  for (Index piece = 0; piece < pieces; ++piece) {
    Positions part = randomSphere(20, static_cast<std::uint64_t>(piece));
    part.colwise() += Eigen::Vector3d(uniform(random), uniform(random), uniform(random)) * 2.0;
    points = horizontally(points, part);
    component.insert(component.end(), 20, piece);
  }
  const NeighborGraph result =
      buildNeighborGraph(points, bruteForceNeighbors(points, 6), test::nearest(6));
  ASSERT_EQ(result.report.components, pieces);
  ASSERT_EQ(result.report.bridges.size(), static_cast<std::size_t>(pieces) - 1);
  double total = 0.0;
  for (const Bridge& bridge : result.report.bridges) {
    EXPECT_NE(component[static_cast<std::size_t>(bridge.from)],
              component[static_cast<std::size_t>(bridge.to)]);
    EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
    total += bridge.length;
    EXPECT_EQ(edgesOf(result.graph).count({bridge.from, bridge.to}), 1U);
    EXPECT_EQ(edgesOf(result.graph).count({bridge.to, bridge.from}), 1U);
  }
  EXPECT_NEAR(total, shortestJoin(points, component, pieces), 1e-9);
  EXPECT_EQ(countReachable(result.graph), points.cols());
}

TEST(NeighborGraph, EmptyListsGiveTheMinimumSpanningTreeOfThePoints) {
  const Positions points = test::cubeGrid(5);  // all ties
  NeighborLists empty;
  empty.offsets.assign(static_cast<std::size_t>(points.cols()) + 1, 0);
  const NeighborGraph result = buildNeighborGraph(points, empty, test::nearest());
  EXPECT_EQ(result.report.components, points.cols());
  EXPECT_EQ(static_cast<Index>(result.report.bridges.size()), points.cols() - 1);
  EXPECT_EQ(countReachable(result.graph), points.cols());
  for (const Bridge& bridge : result.report.bridges)
    EXPECT_DOUBLE_EQ(bridge.length, 0.25);
}

TEST(NeighborGraph, BadInputIsInvalidInput) {
  const Positions points = randomSphere(10, 5);
  const NeighborLists good = bruteForceNeighbors(points, 4);
  EXPECT_THROW(buildNeighborGraph(points, good, test::nearest(2)), InvalidInput);
  NeighborLists bad = good;
  bad.indices[3] = 10;
  EXPECT_THROW(buildNeighborGraph(points, bad, test::nearest()), InvalidInput);
  bad.indices[3] = -1;
  EXPECT_THROW(buildNeighborGraph(points, bad, test::nearest()), InvalidInput);
  bad = good;
  bad.offsets.pop_back();
  EXPECT_THROW(buildNeighborGraph(points, bad, test::nearest()), InvalidInput);
  bad = good;
  std::swap(bad.offsets[2], bad.offsets[3]);
  EXPECT_THROW(buildNeighborGraph(points, bad, test::nearest()), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
