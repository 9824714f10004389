#include "loop_search.h"

#include "graphs.h"

namespace spherical_param {
namespace {

using internal::NumberedGraph;
using internal::Wave;

/// The grid of a torus; node (x, y) is x + width y.
NumberedGraph torusGrid(Index width, Index height) {
  std::vector<std::pair<Index, Index>> edges;
  for (Index y = 0; y < height; ++y)
    for (Index x = 0; x < width; ++x) {
      edges.emplace_back(x + width * y, (x + 1) % width + width * y);
      edges.emplace_back(x + width * y, x + width * ((y + 1) % height));
    }
  return NumberedGraph(test::unitGraph(width * height, edges));
}

/// The shortest loop through a node that crosses the columns from the last to the first oddly.
std::vector<Index> loopThrough(Index node, Index radius, Index width, const NumberedGraph& grid) {
  Wave wave(grid.size());
  return internal::shortestLoopThrough(
      node, radius, grid, [](std::size_t) { return true; },
      [&](std::size_t e) {
        const auto [low, high] = grid.ends[grid.edges[e]];
        return low % width == 0 && high % width == width - 1 ? 1U : 0U;
      },
      wave);
}

TEST(LoopSearch, FindsTheShortestLoopThatCrossesOddly) {
  const NumberedGraph grid = torusGrid(9, 5);
  for (const Index node : {0, 4, 22, 44}) {
    const std::vector<Index> loop = loopThrough(node, 20, 9, grid);
    ASSERT_EQ(loop.size(), 9U);
    EXPECT_EQ(std::count(loop.begin(), loop.end(), node), 1);
    EXPECT_EQ(std::set<Index>(loop.begin(), loop.end()).size(), 9U);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_TRUE(grid.row(loop[i]).contains(loop[(i + 1) % 9]));
  }
}

TEST(LoopSearch, FindsNoLoopBeyondItsRadius) {
  const NumberedGraph grid = torusGrid(9, 5);
  EXPECT_TRUE(loopThrough(22, 3, 9, grid).empty());
  EXPECT_EQ(loopThrough(22, 4, 9, grid).size(), 9U);
}

TEST(LoopSearch, LeavesOutWhatBothWaysShare) {
  EXPECT_EQ(internal::closedWalk({3, 2, 1, 0}, {5, 4, 1, 0}), (std::vector<Index>{1, 2, 3, 5, 4}));
}

}  // namespace
}  // namespace spherical_param
