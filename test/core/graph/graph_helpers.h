#pragma once

#include "helpers.h"
#include "neighbor_graph.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace spherical_param::test {

using Edges = std::set<std::pair<Index, Index>>;

/// The numbers from `begin` to `end`.
inline std::vector<Index> range(Eigen::Index begin, Eigen::Index end) {
  std::vector<Index> result(static_cast<std::size_t>(end - begin));
  std::iota(result.begin(), result.end(), static_cast<Index>(begin));
  return result;
}

/// The outliers of a cloud that reconstruct() leaves out.
inline std::vector<Index> outliersOf(const Positions& points, OutlierMode mode,
                                     double sigma = 4.0) {
  Options options;
  options.outliers = mode;
  options.outlier_sigma = sigma;
  return findOutliers(points, options);
}

/// Row i of a graph, or list i of neighbour lists.
inline std::vector<Index> rowOf(const std::vector<std::size_t>& offsets,
                                const std::vector<Index>& indices, Index i) {
  const auto row = static_cast<std::size_t>(i);
  return {indices.begin() + static_cast<std::ptrdiff_t>(offsets[row]),
          indices.begin() + static_cast<std::ptrdiff_t>(offsets[row + 1])};
}
inline std::vector<Index> rowOf(const Graph& graph, Index i) {
  return rowOf(graph.offsets, graph.neighbors, i);
}
inline std::vector<Index> rowOf(const NeighborLists& lists, Index i) {
  return rowOf(lists.offsets, lists.indices, i);
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
