#include "spherical_param/neighbor_graph.h"

#include "spherical_param/errors.h"

#include "core/component_tree.h"
#include "core/neighbor_lists.h"
#include "core/union_find.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace spherical_param {
namespace {

/// Length of an edge; positive for distinct points even where the squares underflow.
double edgeLength(const Positions& points, Index i, Index j) {
  const Eigen::Vector3d edge = points.col(i) - points.col(j);
  const double squared = edge.squaredNorm();
  constexpr double safe = 1e-280;
  const double length = squared > safe ? std::sqrt(squared) : edge.stableNorm();
  return std::max(length, std::numeric_limits<double>::min());
}

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
      graph.lengths[e] = edgeLength(points, static_cast<Index>(i), graph.neighbors[e]);
  return graph;
}

internal::UnionFind connectedComponents(const Graph& graph) {
  internal::UnionFind parts(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      parts.unite(static_cast<Index>(i), graph.neighbors[e]);
  return parts;
}

/// Minimum spanning tree of the components by their closest pairs of points (Boruvka 1926): in each
/// round every component but the largest finds its shortest edge to another one.
std::vector<Bridge> shortestBridges(const Positions& points, internal::UnionFind& parts,
                                    Index component_count) {
  const auto n = static_cast<Index>(points.cols());
  std::vector<Bridge> bridges;
  std::vector<Index> part(static_cast<std::size_t>(n));
  internal::ComponentTree tree(points);
  while (component_count > 1) {
    std::vector<Index> sizes(static_cast<std::size_t>(n), 0);
    for (Index i = 0; i < n; ++i) {
      part[static_cast<std::size_t>(i)] = parts.find(i);
      ++sizes[static_cast<std::size_t>(part[static_cast<std::size_t>(i)])];
    }
    const auto largest =
        static_cast<Index>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    tree.setComponents(part);

    std::vector<internal::ComponentTree::Pair> shortest(static_cast<std::size_t>(n));
    for (Index i = 0; i < n; ++i) {
      const Index own = part[static_cast<std::size_t>(i)];
      if (own != largest)
        tree.nearestOther(i, shortest[static_cast<std::size_t>(own)]);
    }
    std::sort(shortest.begin(), shortest.end());
    for (const internal::ComponentTree::Pair& pair : shortest) {
      if (pair.from < 0)
        break;  // the parts without a pair sort last
      if (!parts.unite(pair.from, pair.to))
        continue;
      bridges.push_back({pair.from, pair.to, edgeLength(points, pair.from, pair.to)});
      --component_count;
    }
  }
  return bridges;
}

/// The graph with further edges that it does not hold yet.
Graph withEdges(const Graph& graph, const std::vector<Bridge>& edges) {
  std::vector<std::tuple<Index, Index, double>> entries;
  for (const Bridge& edge : edges) {
    entries.emplace_back(edge.from, edge.to, edge.length);
    entries.emplace_back(edge.to, edge.from, edge.length);
  }
  std::sort(entries.begin(), entries.end());
  Graph result;
  result.offsets.reserve(graph.offsets.size());
  result.neighbors.reserve(graph.neighbors.size() + entries.size());
  result.lengths.reserve(graph.neighbors.size() + entries.size());
  auto entry = entries.begin();
  const auto add_entry = [&] {
    result.neighbors.push_back(std::get<1>(*entry));
    result.lengths.push_back(std::get<2>(*entry));
    ++entry;
  };
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const auto in_row = [&] {
      return entry != entries.end() && static_cast<std::size_t>(std::get<0>(*entry)) == i;
    };
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      while (in_row() && std::get<1>(*entry) < graph.neighbors[e])
        add_entry();
      result.neighbors.push_back(graph.neighbors[e]);
      result.lengths.push_back(graph.lengths[e]);
    }
    while (in_row())
      add_entry();
    result.offsets.push_back(result.neighbors.size());
  }
  return result;
}

}  // namespace

NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 const NeighborGraphOptions& options) {
  if (options.k < 3)
    throw InvalidInput("buildNeighborGraph: k = " + std::to_string(options.k) +
                       " is too small; use 3 or more");
  internal::checkNeighborLists("buildNeighborGraph", lists,
                               static_cast<std::size_t>(points.cols()));
  NeighborGraph result;
  result.graph = symmetrized(points, nearestOnly(points, lists, options.k));

  internal::UnionFind parts = connectedComponents(result.graph);
  for (std::size_t i = 0; i < result.graph.size(); ++i)
    result.components += parts.find(static_cast<Index>(i)) == static_cast<Index>(i) ? 1 : 0;
  if (result.components > 1) {
    result.bridges = shortestBridges(points, parts, result.components);
    result.graph = withEdges(result.graph, result.bridges);
  }
  return result;
}

}  // namespace spherical_param
