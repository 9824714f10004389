#include "filled_graph.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

TEST(FilledGraph, FalseEdgesStayWhereTheyKeepItConnected) {
  // A square with a diagonal, and a tail.
  const Graph graph = unitGraph(5, {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 2}, {3, 4}});
  const Graph rest = withoutFalseEdges(randomSphere(5, 1), graph, {{0, 2}, {3, 4}});
  EXPECT_EQ(rest.neighbors, (std::vector<Index>{1, 3, 0, 2, 1, 3, 0, 2, 4, 3}));
}

}  // namespace
}  // namespace spherical_param::test
