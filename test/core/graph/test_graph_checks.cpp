#include "graph_checks.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace spherical_param::internal {
namespace {

/// What a graph of two nodes is refused for, after a change; empty: it is not.
template <typename Change>
std::string refusalAfter(const Change& change) {
  Graph graph;
  graph.offsets = {0, 1, 2};
  graph.neighbors = {1, 0};
  graph.lengths = {1.0, 1.0};
  change(graph);
  try {
    checkGraph("caller", graph);
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return {};
}

TEST(GraphChecks, LengthsMustBeFiniteAndNotNegative) {
  for (const double good : {0.0, 1e-300, 1e300})
    EXPECT_EQ(refusalAfter([&](Graph& graph) { graph.lengths[1] = good; }), "");
  for (const double bad :
       {-1e-300, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NE(refusalAfter([&](Graph& graph) { graph.lengths[1] = bad; }).find("caller: an edge"),
              std::string::npos)
        << bad;
}

TEST(GraphChecks, NeighboursMustBeNodesAndArraysFitEachOther) {
  for (const Index bad : {-1, 2})
    EXPECT_NE(refusalAfter([&](Graph& graph) {
                graph.neighbors[0] = bad;
              }).find("node " + std::to_string(bad) + " of 2"),
              std::string::npos);
  for (const std::vector<std::size_t>& bad :
       std::vector<std::vector<std::size_t>>{{}, {1, 1, 2}, {0, 1, 1}, {0, 1, 3}, {0, 3, 2}})
    EXPECT_NE(refusalAfter([&](Graph& graph) { graph.offsets = bad; }).find("do not fit"),
              std::string::npos);
  EXPECT_NE(refusalAfter([](Graph& graph) { graph.lengths.pop_back(); }).find("do not fit"),
            std::string::npos);
}

}  // namespace
}  // namespace spherical_param::internal
