#include "filled_graph.h"
#include "graphs.h"

#include "graph_cycles.h"
#include "graph_helpers.h"
#include "graphs.h"
#include "open_shapes.h"

namespace spherical_param {
namespace {

using internal::FilledGraph;

TEST(FilledGraph, IsThatOfAClosedSurface) {
  for (const Positions& points :
       {test::hemisphere(800), test::tube(20, 40), test::sphereWithHoles(3000, 5, 0.3)}) {
    const Graph graph = test::graphOf(points, test::bruteForceNeighbors(points, 24)).graph;
    const Openings openings = findOpenings(points, graph);
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
  }
}

TEST(FilledGraph, HasSortedSymmetricRowsWithPositiveLengths) {
  const Positions points = test::sphereWithHoles(1500, 3, 0.4);
  const Graph graph = test::graphOf(points, test::bruteForceNeighbors(points, 24)).graph;
  const Graph filled = internal::fillOpenings(points, graph, findOpenings(points, graph)).graph;
  std::map<std::pair<Index, Index>, double> entries;
  for (std::size_t v = 0; v < filled.size(); ++v)
    for (std::size_t e = filled.offsets[v]; e < filled.offsets[v + 1]; ++e) {
      EXPECT_TRUE(e == filled.offsets[v] || filled.neighbors[e - 1] < filled.neighbors[e]);
      EXPECT_GT(filled.lengths[e], 0.0);
      entries[{static_cast<Index>(v), filled.neighbors[e]}] = filled.lengths[e];
    }
  for (const auto& [edge, length] : entries)
    EXPECT_EQ(entries.at({edge.second, edge.first}), length);
}

TEST(FilledGraph, KeepsFalseEdgesThatJoinTheRest) {
  // A path of three nodes, none of them at an opening.
  Positions points(3, 3);
  points << 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  Graph path;
  path.offsets = {0, 1, 3, 4};
  path.neighbors = {1, 0, 2, 1};
  path.lengths = {1.0, 1.0, 1.0, 1.0};
  Openings openings;
  openings.spacing = {1.0, 1.0, 1.0};
  openings.false_edges = {{0, 1}};
  EXPECT_EQ(internal::fillOpenings(points, path, openings).graph.neighbors, path.neighbors);
}

}  // namespace
}  // namespace spherical_param
