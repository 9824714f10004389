#pragma once

#include "graph.h"
#include "graphs.h"
#include "spherical_param/reconstruct.h"

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
  for (const Index i : graph.nodes())
    for (const Index j : graph.row(i))
      edges.insert({i, j});
  return edges;
}

/// Nodes that can be reached from another node, itself included, without node `removed`.
inline Index countReachable(const Graph& graph, Index removed = -1) {
  std::set<Index> seen{removed};
  std::vector<Index> reached{removed == 0 ? 1 : 0};
  seen.insert(reached[0]);
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (const Index j : graph.row(reached[k]))
      if (seen.insert(j).second)
        reached.push_back(j);
  return static_cast<Index>(reached.size());
}

inline bool hasCutNode(const Graph& graph) {
  const auto n = static_cast<Index>(graph.size());
  const std::vector<Index> nodes = range(0, n);
  return std::any_of(nodes.begin(), nodes.end(),
                     [&](Index i) { return countReachable(graph, i) < n - 1; });
}

/// Points with a tangent plane but without a certified cell.
inline Index countUncertified(const Stars& stars) {
  return static_cast<Index>(
      std::count_if(stars.of_node.begin(), stars.of_node.end(),
                    [](const auto& star) { return star.tangent_plane && star.wants_more; }));
}

inline Index countWithoutPlane(const Stars& stars) {
  return static_cast<Index>(std::count_if(stars.of_node.begin(), stars.of_node.end(),
                                          [](const auto& star) { return !star.tangent_plane; }));
}

/// What every neighbour graph must be: connected, symmetric, in sorted rows, with distances.
inline void expectConnectedGraphOf(const Positions& points, const NeighborGraph& result) {
  const Graph& graph = result.graph;
  ASSERT_EQ(static_cast<Index>(graph.size()), points.cols());
  ASSERT_EQ(graph.lengths.size(), graph.neighbors.size());
  EXPECT_EQ(countReachable(graph), points.cols());
  const Edges edges = edgesOf(graph);
  for (const Index i : graph.nodes())
    for (const std::size_t e : graph.entries(i)) {
      const Index j = graph.neighbors[e];
      EXPECT_NE(j, i);
      EXPECT_TRUE(e == graph.begin(i) || graph.neighbors[e - 1] < j);
      EXPECT_EQ(edges.count({j, i}), 1U);
      const double length = (points.col(i) - points.col(j)).stableNorm();
      EXPECT_NEAR(graph.lengths[e], length, 1e-15 * length);
    }
}

/// Points of a grid of spacing 1, moved within their plane by up to `jitter`.
inline Positions sheet(int rows, double height, double jitter, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  return gridOf(rows, rows, [&](int row, int column) {
    return Eigen::Vector3d{column + uniform(random), row + uniform(random), height};
  });
}

/// The same lists out of order, with the point itself and a repetition.
inline NeighborLists untidy(const NeighborLists& lists) {
  NeighborLists result;
  std::mt19937_64 random(7);
  for (const Index i : indicesOf(lists)) {
    std::vector<Index> list = rowOf(lists, i);
    list.insert(list.end(), {i, list.front()});
    std::shuffle(list.begin(), list.end(), random);
    result.indices.insert(result.indices.end(), list.begin(), list.end());
    result.offsets.push_back(result.indices.size());
  }
  return result;
}

}  // namespace spherical_param::test
