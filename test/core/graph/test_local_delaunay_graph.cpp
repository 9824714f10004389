#include "local_delaunay_graph.h"

#include "graph_helpers.h"

namespace spherical_param::test {
namespace {

/// From the k nearest, and more where they are wanted.
NeighborGraph build(const Positions& points, int k = 12) {
  return graphOf(points, bruteForceNeighbors(points, k), bruteForceSearch(points));
}

Stars starsOf(const Positions& points, int k = 12) {
  return test::starsOf(points, bruteForceNeighbors(points, k), bruteForceSearch(points));
}

/// What every graph must be, for four points and more.
void expectSound(const Positions& points, const NeighborGraph& result) {
  expectConnectedGraphOf(points, result);
  for (Index i = 0; i < points.cols(); ++i)
    EXPECT_GE(rowOf(result.graph, i).size(), 3U);
}

TEST(LocalDelaunayGraph, JoinsThePairsOfWhichBothStarsAgree) {
  // A closed surface, and one with a boundary, where cells are not bounded.
  Positions dome = randomSphere(200, 1);
  dome.row(2) = 0.5 * dome.row(2).cwiseAbs();
  for (const Positions& points : {randomSphere(150, 1), dome}) {
    Edges one;
    Edges both;
    const Stars stars = starsOf(points);
    for (const Index i : indicesOf(stars))
      for (const Index j : stars.of(i)) {
        if (one.count({j, i}) > 0)
          both.insert({std::pair(i, j), std::pair(j, i)});
        one.insert({i, j});
      }
    ASSERT_GT(one.size(), both.size());
    const NeighborGraph result = build(points);
    expectSound(points, result);
    EXPECT_EQ(edgesOf(result.graph), both);
    EXPECT_TRUE(result.bridges.empty());
  }
}

TEST(LocalDelaunayGraph, UpTo32NeighboursAreUsedHoweverTheyCome) {
  const Positions points = randomSphere(300, 4);
  const NeighborLists lists = bruteForceNeighbors(points, 32);
  const Edges expected = edgesOf(graphOf(points, lists).graph);
  for (const int k : {0, 5, 12, 40})
    EXPECT_EQ(edgesOf(build(points, k).graph), expected) << k;
  EXPECT_EQ(edgesOf(graphOf(points, untidy(lists)).graph), expected);
  // Without a search, or with one that finds nothing, the lists are all there is.
  const NeighborSearch blind = [](const std::vector<Index>& some, int) {
    NeighborLists nothing;
    nothing.offsets.assign(some.size() + 1, 0);
    return nothing;
  };
  for (const int k : {0, 1, 2, 3, 12}) {
    const NeighborLists few = bruteForceNeighbors(points, k);
    const NeighborGraph result = graphOf(points, few);
    expectSound(points, result);
    EXPECT_EQ(edgesOf(graphOf(points, few, blind).graph), edgesOf(result.graph));
    EXPECT_EQ(countUncertified(test::starsOf(points, few)) > 0, k == 12);
  }
  for (const Index n : {0, 1, 2, 3})
    EXPECT_EQ(static_cast<Index>(edgesOf(build(randomSphere(n, 17)).graph).size()), n * (n - 1));
}

TEST(LocalDelaunayGraph, SquaresHaveNoDiagonalsAndCloseSheetsAreNotJoinedInside) {
  // Corners have two neighbours and are repaired, and so are the ends of sheets.
  const auto is_inside = [](Index i, int rows) {
    return std::min(i / rows, i % rows) > 2 && std::max(i / rows, i % rows) < rows - 3;
  };
  const NeighborGraph squares = build(0.1 * sheet(12, 3.0, 0.0, 1));
  for (Index i = 0; i < 144; ++i)
    if (is_inside(i, 12)) {
      EXPECT_EQ(rowOf(squares.graph, i), (std::vector<Index>{i - 12, i - 1, i + 1, i + 12}));
    }
  const NeighborGraph sheets = build(horizontally(sheet(20, 0.0, 0.2, 6), sheet(20, 1.5, 0.2, 7)));
  for (const auto& [i, j] : edgesOf(sheets.graph))
    EXPECT_FALSE(i < 400 && is_inside(i, 20) && j >= 400) << i << " " << j;
}

TEST(LocalDelaunayGraph, BridgesAreTheClosestPairsWithDifferentEnds) {
  const Positions points = horizontally(randomSphere(60, 8), movedTo(10.0, randomSphere(60, 9)));
  const NeighborGraph result = build(points);
  expectSound(points, result);
  ASSERT_EQ(result.bridges.size(), 3U);
  std::set<Index> taken;
  for (const Bridge& bridge : result.bridges) {
    double shortest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < 60; ++i)
      for (Index j = 60; j < 120; ++j)
        if (taken.count(i) + taken.count(j) == 0)
          shortest = std::min(shortest, (points.col(i) - points.col(j)).norm());
    EXPECT_DOUBLE_EQ(bridge.length, shortest);
    taken.insert({bridge.from, bridge.to});
  }
}

/// Clouds with and without tangent planes, with creases, parts, ties, and of few points.
std::vector<Positions> awkwardClouds() {
  const Positions patch = sheet(8, 0.0, 0.2, 18);
  const Positions sphere = randomSphere(60, 13);
  Positions plate = randomSphere(400, 15);
  plate.row(2) *= 1e-4;
  // Two patches and one point between them.
  const Positions other = horizontally(Eigen::Vector3d(9.5, 3.5, 0.0), movedTo(12.0, patch));
  std::vector<Positions> clouds{
      cubeGrid(3), cubeGrid(7), spiralSphere(500), plate, patch, horizontally(patch, other),
      // Clusters so small that the squares of their distances are near the least there are, or 0.
      horizontally(sphere, 1e-150 * randomSphere(40, 12)),
      horizontally(sphere, 1e-250 * randomSphere(40, 12)),
      horizontally(sphere, movedTo(10.0, randomSphere(60, 3))),
      horizontally(patch, sheet(8, 0.7, 0.2, 5))};
  for (Index n = 4; n <= 16; ++n)
    clouds.push_back(randomSphere(n, 5));
  return clouds;
}

TEST(LocalDelaunayGraph, EveryCloudHasASoundGraphWithoutACutNode) {
  for (const Positions& points : awkwardClouds()) {
    SCOPED_TRACE(points.cols());
    const NeighborGraph result = build(points);
    expectSound(points, result);
    EXPECT_FALSE(hasCutNode(result.graph));
  }
  for (const double width : {0.1, 1e-2, 1e-3, 1e-8}) {
    Positions needle = randomSphere(200, 14);
    needle.topRows(2) *= width;
    const NeighborGraph result = build(needle);
    expectSound(needle, result);
    // The thin ones are connected, by single points that are tied.
    EXPECT_EQ(result.bridges.empty(), width == 0.1);
  }
}

}  // namespace
}  // namespace spherical_param::test
