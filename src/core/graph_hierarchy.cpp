#include "spherical_param/graph_hierarchy.h"

#include "core/members.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// A level that keeps more than this share of the nodes is not worth having.
constexpr double kLeastCoarsening = 0.9;

/// A graph of more neighbours a node is far from planar, as one of k nearest neighbours is, and no
/// start for an embedding: its aggregates touch only where the surface does.
constexpr int kPlanarDegree = 12;

/// All nodes in an order that looks random, but comes from the lengths of their edges alone:
/// moving, turning, scaling or renumbering the points changes it only where rounding decides.
std::vector<Index> scrambled(const Graph& graph, std::uint32_t seed) {
  const std::size_t n = graph.size();
  std::vector<std::pair<double, Index>> keys(n);
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      keys[i].first += graph.lengths[e];
    keys[i].second = static_cast<Index>(i);
    sum += keys[i].first;
  }
  // About one turn over the spread of the lengths, which is a part of their mean; each seed begins
  // it elsewhere. More turns would look more random, but let the rounding of the points decide more
  // often.
  constexpr double turns = 2.0;
  constexpr double golden_ratio = 0.6180339887498949;
  const double factor = turns * static_cast<double>(n) / sum;
  for (auto& [key, node] : keys) {
    const double turn = factor * key + golden_ratio * seed;
    key = turn - std::floor(turn);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> order(n);
  for (std::size_t i = 0; i < n; ++i)
    order[i] = keys[i].second;
  return order;
}

/// A maximal independent set, in ascending order.
std::vector<Index> independentSet(const Graph& graph, std::uint32_t seed) {
  const std::size_t n = graph.size();
  std::vector<bool> is_covered(n, false);
  std::vector<bool> is_chosen(n, false);
  for (const Index node : scrambled(graph, seed)) {
    const auto i = static_cast<std::size_t>(node);
    if (is_covered[i])
      continue;
    is_chosen[i] = true;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      is_covered[static_cast<std::size_t>(graph.neighbors[e])] = true;
  }
  std::vector<Index> chosen;
  for (std::size_t i = 0; i < n; ++i)
    if (is_chosen[i])
      chosen.push_back(static_cast<Index>(i));
  return chosen;
}

/// Geodesic Voronoi cells of seeds.
struct Aggregates {
  std::vector<Index> of_node;     ///< n entries, positions in `seeds`
  std::vector<double> distances;  ///< n entries, length of the path to the own seed
};

/// Shortest paths from all seeds at once, by relaxation in sweeps over the nodes: no node is far
/// from a seed, so that a few sweeps reach what Dijkstra's algorithm would.
Aggregates geodesicCells(const Graph& graph, const std::vector<Index>& seeds) {
  const std::size_t n = graph.size();
  Aggregates cells{std::vector<Index>(n, -1),
                   std::vector<double>(n, std::numeric_limits<double>::infinity())};
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    cells.of_node[static_cast<std::size_t>(seeds[s])] = static_cast<Index>(s);
    cells.distances[static_cast<std::size_t>(seeds[s])] = 0.0;
  }
  // First the nodes next to a seed, from the seeds alone; then all, until nothing changes.
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(graph.neighbors[e]);
        const double distance = cells.distances[j] + graph.lengths[e];
        // Ties go to the lower seed, whatever the order of the visits.
        if (cells.of_node[j] >= 0 &&
            (distance < cells.distances[i] ||
             (distance == cells.distances[i] && cells.of_node[j] < cells.of_node[i]))) {
          cells.distances[i] = distance;
          cells.of_node[i] = cells.of_node[j];
          changed = true;
        }
      }
  }
  return cells;
}

/// The graph of the aggregates that touch.
Graph coarseGraph(const Graph& graph, const Aggregates& cells, std::size_t count) {
  const internal::Members members(cells.of_node, count);
  Graph coarse;
  coarse.offsets.reserve(count + 1);
  std::vector<double> shortest(count, std::numeric_limits<double>::infinity());
  std::vector<Index> touched;
  for (std::size_t c = 0; c < count; ++c) {
    touched.clear();
    members.forEach(static_cast<Index>(c), [&](Index member) {
      const auto i = static_cast<std::size_t>(member);
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(graph.neighbors[e]);
        const auto other = static_cast<std::size_t>(cells.of_node[j]);
        if (other == c)
          continue;
        if (shortest[other] == std::numeric_limits<double>::infinity())
          touched.push_back(static_cast<Index>(other));
        // The sum of the distances first: the same bits from both sides of the edge.
        const double length = (cells.distances[i] + cells.distances[j]) + graph.lengths[e];
        shortest[other] = std::min(shortest[other], length);
      }
    });
    std::sort(touched.begin(), touched.end());
    for (const Index other : touched) {
      coarse.neighbors.push_back(other);
      coarse.lengths.push_back(shortest[static_cast<std::size_t>(other)]);
      shortest[static_cast<std::size_t>(other)] = std::numeric_limits<double>::infinity();
    }
    coarse.offsets.push_back(coarse.neighbors.size());
  }
  return coarse;
}

Eigen::SparseMatrix<double, Eigen::RowMajor, Index>
interpolation(const Graph& graph, const std::vector<Index>& seeds, const Aggregates& cells) {
  const std::size_t n = graph.size();
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> result(
      static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(seeds.size()));
  result.reserve(static_cast<Eigen::Index>(3 * n));
  std::vector<std::pair<Index, double>> row;  // seed, length of the shortest path
  for (std::size_t i = 0; i < n; ++i) {
    row.clear();
    row.emplace_back(cells.of_node[i], cells.distances[i]);
    if (cells.distances[i] > 0.0)
      for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(graph.neighbors[e]);
        row.emplace_back(cells.of_node[j], cells.distances[j] + graph.lengths[e]);
      }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end(),
                          [](const auto& a, const auto& b) { return a.first == b.first; }),
              row.end());
    const double own = cells.distances[i];
    double sum = 0.0;
    for (auto& [seed, weight] : row) {
      weight = own > 0.0 ? own / weight : 1.0;
      sum += weight;
    }
    result.startVec(static_cast<Eigen::Index>(i));
    for (const auto& [seed, weight] : row)
      result.insertBackByOuterInner(static_cast<Eigen::Index>(i), seed) = weight / sum;
  }
  result.finalize();
  return result;
}

HierarchyLevel coarsened(const Graph& graph, std::uint32_t seed) {
  HierarchyLevel level;
  level.seeds = independentSet(graph, seed);
  Aggregates cells = geodesicCells(graph, level.seeds);
  level.graph = coarseGraph(graph, cells, level.seeds.size());
  level.prolongation = interpolation(graph, level.seeds, cells);
  level.aggregate_of = std::move(cells.of_node);
  return level;
}

}  // namespace

GraphHierarchy buildGraphHierarchy(const Graph& graph, const HierarchyOptions& options) {
  if (options.coarsest_size < 4)
    throw InvalidInput("buildGraphHierarchy: coarsest_size = " +
                       std::to_string(options.coarsest_size) + "; use 4 or more");
  if (graph.neighbors.size() != graph.offsets.back() ||
      graph.lengths.size() != graph.neighbors.size())
    throw InvalidInput("buildGraphHierarchy: the graph's arrays differ in length; use a graph from "
                       "buildNeighborGraph()");
  GraphHierarchy hierarchy;
  const Graph* finest = &graph;
  const auto is_dense = [](const Graph& level) {
    return level.neighbors.size() > static_cast<std::size_t>(kPlanarDegree) * level.size();
  };
  while (finest->size() > static_cast<std::size_t>(options.coarsest_size) || is_dense(*finest)) {
    HierarchyLevel level = coarsened(*finest, options.seed);
    // Fewer than 4 nodes cannot be spread over a sphere.
    if (level.graph.size() < 4 || static_cast<double>(level.graph.size()) >
                                      kLeastCoarsening * static_cast<double>(finest->size()))
      break;
    hierarchy.levels.push_back(std::move(level));
    finest = &hierarchy.levels.back().graph;
  }
  return hierarchy;
}

}  // namespace spherical_param
