#include "graphs.h"
#include "nearest_neighbor_graph.h"

#include "graph_helpers.h"
#include "union_find.h"

#include <tuple>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::edgesOf;
using test::nearest;
using test::randomSphere;

/// Total length of the minimum spanning tree over the parts (J. B. Kruskal, 1956, on all pairs).
double shortestJoin(const Positions& points, internal::UnionFind parts) {
  std::vector<std::tuple<double, Index, Index>> pairs;
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = 0; j < i; ++j)
      pairs.emplace_back((points.col(i) - points.col(j)).norm(), i, j);
  std::sort(pairs.begin(), pairs.end());
  double total = 0.0;
  for (const auto& [length, i, j] : pairs)
    total += parts.unite(i, j) ? length : 0.0;
  return total;
}

TEST(NearestNeighborGraph, JoinsEachPointToItsKNearestInLongUntidyLists) {
  const Positions points = randomSphere(300, 1);
  for (const int k : {3, 7}) {
    const NeighborLists lists = bruteForceNeighbors(points, k);
    test::Edges expected;
    for (Index i = 0; i < points.cols(); ++i)
      for (const Index j : test::rowOf(lists, i))
        expected.insert({std::pair(i, j), std::pair(j, i)});
    const NeighborGraph result =
        test::graphOf(points, test::untidy(bruteForceNeighbors(points, 20)), nearest(k));
    test::expectConnectedGraphOf(points, result);
    for (const Bridge& bridge : result.bridges)
      expected.insert({std::pair(bridge.from, bridge.to), std::pair(bridge.to, bridge.from)});
    EXPECT_EQ(edgesOf(result.graph), expected);
  }
}

TEST(NearestNeighborGraph, ComponentsAreJoinedByTheirMinimumSpanningTree) {
  Positions points(3, 0);
  internal::UnionFind parts(180);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  const Index pieces = 9;
  for (Index piece = 0; piece < pieces; ++piece) {
    Positions part = randomSphere(20, static_cast<std::uint64_t>(piece));
    part.colwise() += Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
    points = test::horizontally(points, part);
    for (Index i = 1; i < 20; ++i)
      parts.unite(20 * piece, 20 * piece + i);
  }
  const NeighborGraph result = test::graphOf(points, bruteForceNeighbors(points, 6), nearest(6));
  test::expectConnectedGraphOf(points, result);
  ASSERT_EQ(result.bridges.size(), static_cast<std::size_t>(pieces) - 1);
  double total = 0.0;
  for (const Bridge& bridge : result.bridges) {
    EXPECT_NE(bridge.from / 20, bridge.to / 20);
    EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
    total += bridge.length;
    EXPECT_EQ(edgesOf(result.graph).count({bridge.from, bridge.to}), 1U);
  }
  EXPECT_NEAR(total, shortestJoin(points, parts), 1e-9);
}

TEST(NearestNeighborGraph, OfEmptyListsIsTheMinimumSpanningTreeOfThePoints) {
  const Positions points = test::cubeGrid(5);  // all ties
  const NeighborGraph result = test::graphOf(points, bruteForceNeighbors(points, 0), nearest());
  test::expectConnectedGraphOf(points, result);
  EXPECT_EQ(result.graph.edgeCount(), static_cast<std::size_t>(points.cols()) - 1);
  EXPECT_EQ(result.bridges.size(), result.graph.edgeCount());
  for (const double length : result.graph.lengths)
    EXPECT_DOUBLE_EQ(length, 0.25);
}

TEST(NeighborGraph, TwentyFiveOrTwelveNeighboursAreToBeSearchedUnlessKIsSet) {
  Options options;
  EXPECT_EQ(neighborsToSearch(options), 12);
  options.graph = GraphMethod::NearestNeighbors;
  EXPECT_EQ(neighborsToSearch(options), 25);
  options.k = 7;
  EXPECT_EQ(neighborsToSearch(options), 7);
}

}  // namespace
}  // namespace spherical_param
