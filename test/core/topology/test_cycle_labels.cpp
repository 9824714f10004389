#include "cycle_labels.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

TEST(CycleLabels, EdgesWithoutABitAreLeftOut) {
  // Two nodes joined by many ways of two steps: a cycle for each way but the first.
  for (const Index ways : {65, 66, 200}) {
    std::vector<std::pair<Index, Index>> edges;
    for (Index way = 0; way < ways; ++way) {
      edges.emplace_back(0, 2 + way);
      edges.emplace_back(2 + way, 1);
    }
    const NumberedGraph graph(unitGraph(2 + ways, edges));
    CycleLabels labels(graph, {});
    EXPECT_EQ(labels.rank(), 64);
    EXPECT_EQ(labels.areComplete(), ways == 65);
    Index left_out = 0;
    for (std::uint32_t edge = 0; edge < graph.ends.size(); ++edge)
      left_out += labels.isLeftOut(edge) ? 1 : 0;
    EXPECT_EQ(left_out, ways - 65);
    labels.fill(CycleLabels::Label{1} << 63);
    EXPECT_EQ(labels.rank(), 63);
  }
}

}  // namespace
}  // namespace spherical_param::test
