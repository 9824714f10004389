#include "graph_hierarchy.h"

#include "graph_building.h"
#include "progress.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Numbers that look random, but depend only on the lengths of the edges of each node: moving,
/// turning, scaling or renumbering the points changes them only by rounding.
Indexed<double> scrambledKeys(const Graph& graph, std::uint32_t seed, int threads) {
  Indexed<double> keys(graph.size());
  forEachIndex(graph.size(), threads, {}, [&](Index i) {
    const Row<double> lengths = graph.lengthsOf(i);
    keys[i] = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  });
  const double sum = std::accumulate(keys.begin(), keys.end(), 0.0);
  // About one turn over the spread of the lengths; each seed begins it elsewhere. With more turns,
  // the rounding of the points would decide more often.
  constexpr double turns = 2.0;
  constexpr double golden_ratio = 0.6180339887498949;
  const double factor = turns * static_cast<double>(graph.size()) / sum;
  for (double& key : keys) {
    const double turn = factor * key + golden_ratio * seed;
    // NaN, from lengths that are not finite, cannot be sorted.
    key = std::isfinite(turn) ? turn - std::floor(turn) : 0.0;
  }
  return keys;
}

/// A maximal independent set, in ascending order: takes each node by ascending key, unless a
/// neighbour was taken before it. A node can be judged as soon as its neighbours of lower keys are.
/// So each round leaves fewer nodes, and the set does not depend on the threads.
Indexed<Index> independentSet(const Graph& graph, std::uint32_t seed, int threads,
                              const FractionReport& report) {
  const std::size_t n = graph.size();
  const Indexed<double> keys = scrambledKeys(graph, seed, threads);
  reportFraction(report, 0.0);
  enum State : unsigned char { Open, Out, Taken };
  Indexed<std::atomic<unsigned char>> states(n);
  const auto judge = [&](Index i) {
    if (states[i].load(std::memory_order_relaxed) != Open)
      return true;
    bool waits = false;
    for (const Index j : graph.row(i)) {
      if (keys[j] > keys[i] || (keys[j] == keys[i] && j > i))
        continue;
      const unsigned char state = states[j].load(std::memory_order_relaxed);
      if (state == Taken) {
        states[i].store(Out, std::memory_order_relaxed);
        return true;
      }
      waits = waits || state == Open;
    }
    if (waits)
      return false;
    states[i].store(Taken, std::memory_order_relaxed);
    for (const Index j : graph.row(i))
      states[j].store(Out, std::memory_order_relaxed);
    return true;
  };
  std::vector<Index> waiting = collectBlocks<Index>(
      n, threads, report, [&](Index begin, Index end, std::vector<Index>& nodes) {
        for (const Index i : NumberRange(begin, end))
          if (!judge(i))
            nodes.push_back(i);
      });
  while (!waiting.empty()) {
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(), judge), waiting.end());
    reportFraction(report, 0.0);
  }
  Indexed<Index> taken;
  for (const Index i : graph.nodes())
    if (states[i].load(std::memory_order_relaxed) == Taken)
      taken.push_back(i);
  return taken;
}

/// Geodesic Voronoi cells of seeds.
struct Aggregates {
  Indexed<Index> of_node;     ///< n entries, numbers of seeds
  Indexed<double> distances;  ///< n entries, length of the path to the own seed

  /// Gives a node the seed of a neighbour if the path through it is shorter; ties go to the lower
  /// seed. \return whether the node has changed
  bool join(Index node, const Aggregates& of, Index neighbor, double length) {
    const double distance = of.distances[neighbor] + length;
    const Index seed = of.of_node[neighbor];
    if (!(distance < distances[node] || (distance == distances[node] && seed < of_node[node])))
      return false;
    distances[node] = distance;
    of_node[node] = seed;
    return true;
  }
};

/// Shortest paths from all seeds at once. First come the neighbours of seeds, then all nodes, in
/// parallel. No node is far from a seed, so few change after that.
Aggregates geodesicCells(const Graph& graph, const Indexed<Index>& seeds, int threads,
                         const FractionReport& report) {
  const std::size_t n = graph.size();
  Aggregates near{Indexed<Index>(n, -1),
                  Indexed<double>(n, std::numeric_limits<double>::infinity())};
  for (const Index s : indicesOf(seeds)) {
    near.of_node[seeds[s]] = s;
    near.distances[seeds[s]] = 0.0;
    for (const std::size_t e : graph.entries(seeds[s]))
      near.join(graph.neighbors[e], near, seeds[s], graph.lengths[e]);
  }
  reportFraction(report, 0.0);
  Aggregates cells = near;
  std::vector<Index> queue = collectBlocks<Index>(
      n, threads, report, [&](Index begin, Index end, std::vector<Index>& changed) {
        for (const Index i : NumberRange(begin, end)) {
          bool changes = false;
          for (const std::size_t e : graph.entries(i))
            changes = cells.join(i, near, graph.neighbors[e], graph.lengths[e]) || changes;
          if (changes)
            changed.push_back(i);
        }
      });
  for (std::size_t head = 0; head < queue.size(); ++head)
    for (const std::size_t e : graph.entries(queue[head])) {
      const Index i = graph.neighbors[e];
      if (cells.join(i, cells, queue[head], graph.lengths[e]))
        queue.push_back(i);
    }
  return cells;
}

/// The graph of the aggregates that touch.
Graph coarseGraph(const Graph& graph, const Aggregates& cells, std::size_t count, int threads,
                  const FractionReport& report) {
  const NeighborRows nodes = nodesOfParts(cells.of_node, count);
  reportFraction(report, 0.0);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<Indexed<double>> memory(static_cast<std::size_t>(threads));
  return rowsOfBlocks(count, threads, report, [&](Index begin, Index end, Graph& rows) {
    Indexed<double>& shortest = memory[threadNumber()];
    shortest.resize(count, infinity);
    std::vector<Index> touched;
    for (const Index own : NumberRange(begin, end)) {
      touched.clear();
      for (const Index i : nodes.row(own))
        for (const std::size_t e : graph.entries(i)) {
          const Index j = graph.neighbors[e];
          const Index other = cells.of_node[j];
          if (other == own)
            continue;
          if (shortest[other] == infinity)
            touched.push_back(other);
          // The distances are added first: the sum has the same bits from both sides of the edge.
          // It stays finite.
          const double length = (cells.distances[i] + cells.distances[j]) + graph.lengths[e];
          shortest[other] = std::min({shortest[other], length, std::numeric_limits<double>::max()});
        }
      std::sort(touched.begin(), touched.end());
      for (const Index other : touched) {
        rows.neighbors.push_back(other);
        rows.lengths.push_back(std::exchange(shortest[other], infinity));
      }
      rows.endRow();
    }
  });
}

/// Adds an entry to a row that is sorted by seed; of two paths to a seed the shorter one stays.
void addPath(std::vector<std::pair<Index, double>>& row, Index seed, double length) {
  auto place = row.end();
  while (place != row.begin() && (place - 1)->first > seed)
    --place;
  if (place != row.begin() && (place - 1)->first == seed)
    (place - 1)->second = std::min((place - 1)->second, length);
  else
    row.emplace(place, seed, length);
}

SparseRows interpolation(const Graph& graph, const Aggregates& cells, std::size_t count,
                         int threads, const FractionReport& report) {
  const std::size_t n = graph.size();
  const Graph weights = rowsOfBlocks(n, threads, report, [&](Index begin, Index end, Graph& rows) {
    std::vector<std::pair<Index, double>> row;  // seed, length of the shortest path
    for (const Index i : NumberRange(begin, end)) {
      row.clear();
      row.emplace_back(cells.of_node[i], cells.distances[i]);
      const double own = cells.distances[i];
      if (own > 0.0)
        for (const std::size_t e : graph.entries(i)) {
          const Index j = graph.neighbors[e];
          addPath(row, cells.of_node[j], cells.distances[j] + graph.lengths[e]);
        }
      double sum = 0.0;
      for (auto& [seed, weight] : row) {
        weight = own > 0.0 ? own / weight : 1.0;
        sum += weight;
      }
      for (const auto& [seed, weight] : row) {
        rows.neighbors.push_back(seed);
        rows.lengths.push_back(weight / sum);
      }
      rows.endRow();
    }
  });
  SparseRows result(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(count));
  result.resizeNonZeros(static_cast<Eigen::Index>(weights.neighbors.size()));
  std::transform(weights.offsets.begin(), weights.offsets.end(), result.outerIndexPtr(),
                 [](std::size_t offset) { return static_cast<Index>(offset); });
  std::copy(weights.neighbors.begin(), weights.neighbors.end(), result.innerIndexPtr());
  std::copy(weights.lengths.begin(), weights.lengths.end(), result.valuePtr());
  return result;
}

}  // namespace

GraphHierarchy buildGraphHierarchy(const Graph& graph, std::uint32_t seed, Index coarsest_size,
                                   const Execution& execution) {
  GraphHierarchy hierarchy;
  const Graph* finest = &graph;
  const FractionReport report = reportOf(execution, "embedding");
  while (finest->size() > static_cast<std::size_t>(coarsest_size)) {
    const int threads = threadCount(execution.threads, finest->size());
    const Indexed<Index> seeds = independentSet(*finest, seed, threads, report);
    // Fewer than 4 nodes cannot be spread over a sphere. If levels kept more than half of the
    // nodes, a hub could have as many levels as neighbours.
    if (seeds.size() < 4 || 2 * seeds.size() > finest->size())
      break;
    const Aggregates cells = geodesicCells(*finest, seeds, threads, report);
    HierarchyLevel& level = hierarchy.levels.emplace_back();
    level.graph = coarseGraph(*finest, cells, seeds.size(), threads, report);
    interpolation(*finest, cells, seeds.size(), threads, report).swap(level.prolongation);
    finest = &level.graph;
  }
  return hierarchy;
}

}  // namespace spherical_param::internal
