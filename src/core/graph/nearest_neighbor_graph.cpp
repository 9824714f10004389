#include "nearest_neighbor_graph.h"

#include "graph_building.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

/// The k nearest entries of each list, without the point itself and without repetitions.
NeighborLists nearestOnly(const Positions& points, const NeighborLists& lists, int k) {
  const std::size_t n = lists.size();
  NeighborLists nearest;
  nearest.offsets.reserve(n + 1);
  nearest.indices.reserve(std::min(lists.indices.size(), n * static_cast<std::size_t>(k)));
  std::vector<std::pair<double, Index>> candidates;
  for (std::size_t i = 0; i < n; ++i) {
    candidates.clear();
    for (std::size_t e = lists.offsets[i]; e < lists.offsets[i + 1]; ++e) {
      const Index j = lists.indices[e];
      if (static_cast<std::size_t>(j) != i)
        candidates.emplace_back(
            (points.col(j) - points.col(static_cast<Eigen::Index>(i))).squaredNorm(), j);
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    const std::size_t count = std::min(candidates.size(), static_cast<std::size_t>(k));
    for (std::size_t c = 0; c < count; ++c)
      nearest.indices.push_back(candidates[c].second);
    nearest.offsets.push_back(nearest.indices.size());
  }
  return nearest;
}

/// Joins i and j wherever one names the other. Rows are sorted and free of repetitions.
Graph symmetrized(const Positions& points, const NeighborLists& directed) {
  const std::size_t n = directed.size();
  std::vector<std::size_t> row_begin(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    row_begin[i + 1] += directed.offsets[i + 1] - directed.offsets[i];
    for (std::size_t e = directed.offsets[i]; e < directed.offsets[i + 1]; ++e)
      ++row_begin[static_cast<std::size_t>(directed.indices[e]) + 1];
  }
  for (std::size_t i = 0; i < n; ++i)
    row_begin[i + 1] += row_begin[i];

  Graph graph;
  graph.neighbors.resize(row_begin[n]);
  std::vector<std::size_t> next(row_begin.begin(), row_begin.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = directed.offsets[i]; e < directed.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(directed.indices[e]);
      graph.neighbors[next[i]++] = static_cast<Index>(j);
      graph.neighbors[next[j]++] = static_cast<Index>(i);
    }

  // Mutual neighbours stand twice in a row now: sort, keep one, close the gaps.
  graph.offsets.assign(n + 1, 0);
  auto write = graph.neighbors.begin();
  for (std::size_t i = 0; i < n; ++i) {
    const auto begin = graph.neighbors.begin() + static_cast<std::ptrdiff_t>(row_begin[i]);
    const auto end = graph.neighbors.begin() + static_cast<std::ptrdiff_t>(row_begin[i + 1]);
    std::sort(begin, end);
    write = std::copy(begin, std::unique(begin, end), write);
    graph.offsets[i + 1] = static_cast<std::size_t>(write - graph.neighbors.begin());
  }
  graph.neighbors.erase(write, graph.neighbors.end());
  graph.neighbors.shrink_to_fit();

  graph.lengths.resize(graph.neighbors.size());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      graph.lengths[e] = internal::edgeLength(points, static_cast<Index>(i), graph.neighbors[e]);
  return graph;
}

}  // namespace

namespace internal {

NeighborGraph buildNearestNeighborGraph(const Positions& points, const NeighborLists& lists,
                                        int k) {
  NeighborGraph result;
  result.graph = symmetrized(points, nearestOnly(points, lists, k));
  UnionFind parts = connectedComponents(result.graph);
  if (countSets(representatives(parts, result.graph.size())) > 1) {
    result.bridges = shortestBridges(points, parts, 1);
    result.graph = withEdges(result.graph, result.bridges);
  }
  return result;
}

}  // namespace internal
}  // namespace spherical_param
