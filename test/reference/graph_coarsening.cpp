#include "reference/graph_coarsening.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::reference {
namespace {

/// The entries of a row of a graph: calls visit(neighbor, length).
template <typename Visit>
void forEachNeighbor(const Graph& graph, std::size_t i, const Visit& visit) {
  for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
    visit(static_cast<std::size_t>(graph.neighbors[e]), graph.lengths[e]);
}

/// Takes each node in turn, by ascending key, unless a neighbour was taken before it.
std::vector<Index> independentSet(const Graph& graph, std::uint32_t seed) {
  const std::size_t n = graph.size();
  std::vector<double> keys(n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    forEachNeighbor(graph, i, [&](std::size_t, double length) { keys[i] += length; });
  const double sum = std::accumulate(keys.begin(), keys.end(), 0.0);
  // The scrambling of the product: two turns over the mean, begun elsewhere by each seed.
  const double factor = 2.0 * static_cast<double>(n) / sum;
  for (double& key : keys) {
    const double turn = factor * key + 0.6180339887498949 * seed;
    key = turn - std::floor(turn);
  }
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < n; ++i)
    order.emplace_back(keys[i], i);
  std::sort(order.begin(), order.end());
  std::vector<bool> out(n, false);
  std::vector<Index> taken;
  for (const auto& [key, i] : order) {
    if (out[i])
      continue;
    taken.push_back(static_cast<Index>(i));
    forEachNeighbor(graph, i, [&](std::size_t j, double) { out[j] = true; });
  }
  std::sort(taken.begin(), taken.end());
  return taken;
}

/// Writes the nearest seed of each node, the lower one of those as near, and the way to it.
void findCells(const Graph& graph, const std::vector<Index>& seeds, std::vector<Index>& cells,
               std::vector<double>& distances) {
  cells.assign(graph.size(), -1);
  distances.assign(graph.size(), std::numeric_limits<double>::infinity());
  using Entry = std::tuple<double, Index, std::size_t>;  // distance, seed, node
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t s = 0; s < seeds.size(); ++s)
    queue.emplace(0.0, static_cast<Index>(s), static_cast<std::size_t>(seeds[s]));
  while (!queue.empty()) {
    const auto [distance, seed, i] = queue.top();
    queue.pop();
    if (cells[i] >= 0)
      continue;
    cells[i] = seed;
    distances[i] = distance;
    forEachNeighbor(graph, i, [&, from = distance, of = seed](std::size_t j, double length) {
      if (cells[j] < 0)
        queue.emplace(from + length, of, j);
    });
  }
}

/// Keeps the shortest way to each node of a row.
void offer(std::map<Index, double>& row, Index to, double length) {
  const auto [place, is_new] = row.try_emplace(to, length);
  if (!is_new)
    place->second = std::min(place->second, length);
}

}  // namespace

internal::HierarchyLevel coarsen(const Graph& graph, std::uint32_t seed) {
  internal::HierarchyLevel level;
  level.seeds = independentSet(graph, seed);
  std::vector<double> distances;
  findCells(graph, level.seeds, level.aggregate_of, distances);

  std::vector<std::map<Index, double>> rows(level.seeds.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    forEachNeighbor(graph, i, [&](std::size_t j, double length) {
      const Index from = level.aggregate_of[i];
      const Index to = level.aggregate_of[j];
      if (from != to)
        offer(rows[static_cast<std::size_t>(from)], to, (distances[i] + distances[j]) + length);
    });
  for (const auto& row : rows) {
    for (const auto& [to, length] : row) {
      level.graph.neighbors.push_back(to);
      level.graph.lengths.push_back(length);
    }
    level.graph.offsets.push_back(level.graph.neighbors.size());
  }

  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const double own = distances[i];
    std::map<Index, double> row{{level.aggregate_of[i], own}};
    if (own > 0.0)
      forEachNeighbor(graph, i, [&](std::size_t j, double length) {
        offer(row, level.aggregate_of[j], distances[j] + length);
      });
    double sum = 0.0;
    for (auto& [to, weight] : row) {
      weight = own > 0.0 ? own / weight : 1.0;
      sum += weight;
    }
    for (const auto& [to, weight] : row)
      entries.emplace_back(static_cast<Index>(i), to, weight / sum);
  }
  level.prolongation.resize(static_cast<Eigen::Index>(graph.size()),
                            static_cast<Eigen::Index>(level.seeds.size()));
  level.prolongation.setFromTriplets(entries.begin(), entries.end());
  return level;
}

}  // namespace spherical_param::reference
