#include "filled_graph.h"

#include "core/graph/graph_helpers.h"
#include "graph_cycles.h"
#include "graphs.h"
#include "open_shapes.h"
#include "topologies.h"

namespace spherical_param {
namespace {

using internal::FilledGraph;

void expectSortedSymmetricRowsWithPositiveLengths(const Graph& graph) {
  std::map<std::pair<Index, Index>, double> entries;
  for (std::size_t v = 0; v < graph.size(); ++v)
    for (std::size_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e) {
      EXPECT_TRUE(e == graph.offsets[v] || graph.neighbors[e - 1] < graph.neighbors[e]);
      EXPECT_GT(graph.lengths[e], 0.0);
      entries[{static_cast<Index>(v), graph.neighbors[e]}] = graph.lengths[e];
    }
  for (const auto& [edge, length] : entries)
    EXPECT_EQ(entries.at({edge.second, edge.first}), length);
}

TEST(FilledGraph, IsThatOfAClosedSurface) {
  for (const Positions& points :
       {test::hemisphere(800), test::tube(20, 40), test::sphereWithHoles(3000, 5, 0.3)}) {
    const Graph graph = test::graphOf(points, test::bruteForceNeighbors(points, 24)).graph;
    const Openings openings = test::openingsOf(points, graph);
    const FilledGraph filled = internal::fillOpenings(points, graph, openings);
    EXPECT_EQ(internal::countCycles(filled.graph, 2), 0);
    // About twice as many nodes as the loops have.
    std::size_t loops = 0;
    for (const Opening& opening : openings.openings)
      loops += opening.loop.size();
    const std::size_t added = filled.graph.size() - graph.size();
    EXPECT_GT(added, loops);
    EXPECT_LT(added, 3 * loops + openings.openings.size());
    EXPECT_EQ(static_cast<std::size_t>(filled.points.cols()), filled.graph.size());
    EXPECT_EQ(filled.points.leftCols(points.cols()), points);
    EXPECT_TRUE(filled.points.allFinite());
    expectSortedSymmetricRowsWithPositiveLengths(filled.graph);
  }
}

TEST(FilledGraph, KeepsFalseEdgesThatJoinTheRest) {
  // A path of three nodes, none of them at an opening.
  Positions points(3, 3);
  points << 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  const Graph path = test::unitGraph(3, {{0, 1}, {1, 2}});
  Openings openings;
  openings.spacing = {1.0, 1.0, 1.0};
  openings.false_edges = {{0, 1}};
  EXPECT_EQ(internal::fillOpenings(points, path, openings).graph.neighbors, path.neighbors);
}

}  // namespace
}  // namespace spherical_param
