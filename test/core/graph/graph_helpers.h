#pragma once

#include "graph.h"
#include "graphs.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

namespace spherical_param::test {

using Edges = std::set<std::pair<Index, Index>>;

/// The outliers of a cloud that reconstruct() leaves out.
inline std::vector<Index> outliersOf(const Positions& points, OutlierMode mode,
                                     double sigma = 4.0) {
  Options options;
  options.outliers = mode;
  options.outlier_sigma = sigma;
  return findOutliers(points, options);
}

/// All pairs of neighbours, in both directions.
inline Edges edgesOf(const Graph& graph) {
  Edges edges;
  for (Index i = 0; i < static_cast<Index>(graph.size()); ++i)
    for (const Index j : rowOf(graph, i))
      edges.insert({i, j});
  return edges;
}

/// Nodes that can be reached from another node, itself included, without node `removed`.
inline Index countReachable(const Graph& graph, Index removed = -1) {
  std::vector<bool> seen(graph.size(), false);
  if (removed >= 0)
    seen[static_cast<std::size_t>(removed)] = true;
  std::vector<Index> stack{removed == 0 ? 1 : 0};
  seen[static_cast<std::size_t>(stack[0])] = true;
  Index count = 0;
  while (!stack.empty()) {
    const Index i = stack.back();
    stack.pop_back();
    ++count;
    for (const Index j : rowOf(graph, i))
      if (!seen[static_cast<std::size_t>(j)]) {
        seen[static_cast<std::size_t>(j)] = true;
        stack.push_back(j);
      }
  }
  return count;
}

inline bool hasCutNode(const Graph& graph) {
  const auto n = static_cast<Index>(graph.size());
  for (Index i = 0; i < n; ++i)
    if (countReachable(graph, i) < n - 1)
      return true;
  return false;
}

/// What every neighbour graph must be: connected, symmetric, in sorted rows, with distances.
inline void expectConnectedGraphOf(const Positions& points, const NeighborGraph& result) {
  const Graph& graph = result.graph;
  ASSERT_EQ(static_cast<Index>(graph.size()), points.cols());
  ASSERT_EQ(graph.lengths.size(), graph.neighbors.size());
  EXPECT_EQ(countReachable(graph), points.cols());
  const Edges edges = edgesOf(graph);
  for (Index i = 0; i < points.cols(); ++i) {
    const std::vector<Index> row = rowOf(graph, i);
    for (std::size_t k = 0; k < row.size(); ++k) {
      EXPECT_NE(row[k], i);
      EXPECT_TRUE(k == 0 || row[k - 1] < row[k]);
      EXPECT_EQ(edges.count({row[k], i}), 1U);
      const double length = (points.col(i) - points.col(row[k])).stableNorm();
      EXPECT_NEAR(graph.lengths[graph.offsets[static_cast<std::size_t>(i)] + k], length,
                  1e-15 * length);
    }
  }
}

/// Bridges are, one after the other, the closest pairs of two parts whose ends are not taken yet.
inline void expectClosestPairs(const Positions& points, const std::vector<Bridge>& bridges,
                               const std::function<bool(Index)>& is_inner,
                               std::set<Index> taken = {}) {
  for (const Bridge& bridge : bridges) {
    double shortest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < points.cols(); ++i)
      for (Index j = 0; j < points.cols(); ++j)
        if (is_inner(i) && !is_inner(j) && taken.count(i) == 0 && taken.count(j) == 0)
          shortest = std::min(shortest, (points.col(i) - points.col(j)).norm());
    EXPECT_DOUBLE_EQ(bridge.length, shortest);
    taken.insert({bridge.from, bridge.to});
  }
}

/// The same lists out of order, with the point itself and a repetition.
inline NeighborLists untidy(const NeighborLists& lists) {
  NeighborLists result;
  std::mt19937_64 random(7);
  for (Index i = 0; i < static_cast<Index>(lists.size()); ++i) {
    std::vector<Index> list = rowOf(lists, i);
    list.insert(list.end(), {i, list.front()});
    std::shuffle(list.begin(), list.end(), random);
    result.indices.insert(result.indices.end(), list.begin(), list.end());
    result.offsets.push_back(result.indices.size());
  }
  return result;
}

}  // namespace spherical_param::test
