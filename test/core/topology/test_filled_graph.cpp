#include "filled_graph.h"

#include "graphs.h"
#include "open_shapes.h"

namespace spherical_param::test {
namespace {

TEST(FilledGraph, HasVirtualNodesWithinItsOpeningsAndIsElseAsBefore) {
  const Positions points = tube(20, 40);
  const Graph graph = localDelaunayGraph(points).graph;
  const Openings openings = openingsOf(points, graph);
  ASSERT_EQ(openings.openings.size(), 2U);
  const FilledGraph filled = fillOpenings(points, graph, openings);
  const auto n = static_cast<Index>(points.cols());
  EXPECT_EQ(filled.points.leftCols(n), points);
  EXPECT_EQ(columnCount(filled.points), filled.graph.size());
  ASSERT_EQ(filled.ends.size(), 2U);
  for (const Index v : filled.graph.nodes()) {
    const std::size_t o = v < filled.ends[0] ? 0 : 1;
    const std::vector<Index>& loop = openings.openings[o].loop;
    std::vector<Index> real;
    for (const Index w : filled.graph.row(v))
      if (w < n)
        real.push_back(w);
    if (v < n) {
      EXPECT_EQ(real, rowOf(graph, v));
      continue;
    }
    EXPECT_LT(filled.points.col(v).head<2>().norm(), 1.0);
    for (const Index w : real)
      EXPECT_EQ(std::count(loop.begin(), loop.end(), w), 1);
  }
  EXPECT_GT(filled.ends[0] - n, 40);
  EXPECT_LE(filled.ends[0] - n, 96);  // 2.4 times the loop
}

TEST(FilledGraph, FalseEdgesStayWhereTheyKeepItConnected) {
  // A square with a diagonal, and a tail.
  const Graph graph = unitGraph(5, {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 2}, {3, 4}});
  const Graph rest = withoutFalseEdges(randomSphere(5, 1), graph, {{0, 2}, {3, 4}});
  EXPECT_EQ(rest.neighbors, (std::vector<Index>{1, 3, 0, 2, 1, 3, 0, 2, 4, 3}));
}

}  // namespace
}  // namespace spherical_param::test
