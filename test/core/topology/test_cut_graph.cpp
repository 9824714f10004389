#include "cut_graph.h"

#include "graph_building.h"
#include "graph_cycles.h"
#include "handle_shapes.h"
#include "topologies.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Number of components of a graph without its edges within some nodes.
Index componentsOf(const Graph& graph) {
  UnionFind sets = connectedComponents(graph);
  std::set<Index> roots;
  for (const Index v : graph.nodes())
    roots.insert(sets.find(v));
  return static_cast<Index>(roots.size());
}

TEST(CutGraph, ACutTorusIsATubeOfTheSameEdges) {
  const test::Topology of(test::torusCloud(40, 12, 1.0, 0.27));
  ASSERT_EQ(of.handles.loops.size(), 1U);
  const CutGraph cut = cutAlong(of.points, of.graph, of.rotation, of.handles.loops);
  const std::size_t n = of.graph.size();
  const std::vector<Index>& loop = of.handles.loops.front().nodes;
  ASSERT_EQ(cut.graph.size(), n + loop.size());
  EXPECT_EQ(cut.graph.edgeCount(), of.graph.edgeCount() + loop.size());
  EXPECT_EQ(componentsOf(cut.graph), 1);
  EXPECT_EQ(countCycles(of.graph, 1), 2);
  EXPECT_EQ(countCycles(cut.graph, 1), 1);  // around the tube
  ASSERT_EQ(cut.rims.size(), 2U);
  EXPECT_EQ(cut.rims[0], loop);
  for (const std::vector<Index>& rim : cut.rims)
    for (std::size_t i = 0; i < rim.size(); ++i)
      EXPECT_TRUE(cut.graph.row(rim[i]).contains(rim[(i + 1) % rim.size()]));
  for (std::size_t v = 0; v < cut.graph.size(); ++v)
    EXPECT_EQ(cut.points.col(static_cast<Eigen::Index>(v)), of.points.col(cut.node_of[v]));
  // Each edge joins copies of nodes that were joined.
  for (const Index v : cut.graph.nodes())
    for (const Index w : cut.graph.row(v))
      EXPECT_TRUE(of.graph.row(cut.node_of[v]).contains(cut.node_of[w]));
}

TEST(CutGraph, CutsOfAllHandlesLeaveOnePiece) {
  const test::Topology of(test::plateWithHoles(0.1));
  const CutGraph cut = cutAlong(of.points, of.graph, of.rotation, of.handles.loops);
  EXPECT_EQ(cut.rims.size(), 10U);
  EXPECT_EQ(componentsOf(cut.graph), 1);
}

}  // namespace
}  // namespace spherical_param::internal
