#include "graph_building.h"

#include "graph_helpers.h"

namespace spherical_param::test {
namespace {

/// Points with a random tree as their graph, and some more edges.
Graph randomGraph(Index n, int extra, std::mt19937_64& random) {
  std::vector<std::pair<Index, Index>> edges;
  const auto below = [&](Index end) {
    return static_cast<Index>(random() % static_cast<std::uint64_t>(end));
  };
  for (Index i = 1; i < n; ++i)
    edges.emplace_back(below(i), i);
  for (; extra > 0; --extra) {
    const Index i = below(n);
    const Index j = below(n);
    if (i != j)
      edges.emplace_back(i, j);
  }
  return unitGraph(n, edges);
}

TEST(GraphBuilding, PartsThatHangByOneNodeAreTiedInAnyGraph) {
  std::mt19937_64 random(19);
  int dangling = 0;
  for (int round = 0; round < 300; ++round) {
    const Index n = 5 + round % 12;
    const Positions points = randomSphere(n, static_cast<std::uint64_t>(round));
    Graph graph = randomGraph(n, round % 14, random);
    ASSERT_EQ(countReachable(graph), n);
    const bool had_cut_node = hasCutNode(graph);
    dangling += had_cut_node ? 1 : 0;
    const std::vector<Bridge> bridges = articulationBridges(points, graph, 2);
    EXPECT_EQ(bridges.empty(), !had_cut_node);
    const Edges before = edgesOf(graph);
    for (const Bridge& bridge : bridges) {
      EXPECT_EQ(before.count({bridge.from, bridge.to}), 0U);
      EXPECT_DOUBLE_EQ(bridge.length, (points.col(bridge.from) - points.col(bridge.to)).norm());
    }
    // Of parts in a chain the ends are tied at first.
    for (Index k = 0; k < n; ++k)
      graph = withEdges(graph, articulationBridges(points, graph, 2));
    EXPECT_FALSE(hasCutNode(graph));
  }
  EXPECT_GT(dangling, 50);
  EXPECT_LT(dangling, 280);
}

}  // namespace
}  // namespace spherical_param::test
