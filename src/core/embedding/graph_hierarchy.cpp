#include "graph_hierarchy.h"

#include "parallel.h"
#include "partition.h"
#include "progress.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace spherical_param::internal {
namespace {

/// A level that keeps more than this fraction of the nodes is left out, and is the last: levels of
/// a hub with n neighbours could be as many as these. No cloud has any: 0.6 and 1 change nothing.
constexpr double kMaxKeptFraction = 0.9;

/// Numbers of the nodes that look random, but come from the lengths of their edges alone: moving,
/// turning, scaling or renumbering the points changes them only where rounding decides.
Indexed<double> scrambledKeys(const Graph& graph, std::uint32_t seed, int threads) {
  Indexed<double> keys(graph.size());
  forEachIndex(graph.size(), threads, {}, [&](Index i) {
    const Row<double> lengths = graph.lengthsOf(i);
    keys[i] = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  });
  const double sum = std::accumulate(keys.begin(), keys.end(), 0.0);
  // About one turn over the spread of the lengths, which is a part of their mean; each seed begins
  // it elsewhere. More turns would look more random, but let the rounding of the points decide more
  // often.
  constexpr double turns = 2.0;
  constexpr double golden_ratio = 0.6180339887498949;
  const double factor = turns * static_cast<double>(graph.size()) / sum;
  for (double& key : keys) {
    const double turn = factor * key + golden_ratio * seed;
    // A length that is NaN gives a key that is NaN, which no comparison orders.
    key = std::isfinite(turn) ? turn - std::floor(turn) : 0.0;
  }
  return keys;
}

/// A maximal independent set, in ascending order: the one that takes each node in turn, by
/// ascending key, unless a neighbour was taken before it. A node can be judged as soon as its
/// neighbours before it are, which leaves fewer and fewer nodes from round to round, and comes to
/// the same set whatever the order and the threads.
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
  Indexed<Index> of_node;     ///< n entries, positions in `seeds`
  Indexed<double> distances;  ///< n entries, length of the path to the own seed

  /// Gives a node the seed of a neighbour if the path through it is shorter; ties go to the lower
  /// seed. \return whether it is
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

/// Shortest paths from all seeds at once. No node is far from a seed: after all nodes next to one
/// and then all nodes have been looked at, only few change, and those next to them.
Aggregates geodesicCells(const Graph& graph, const Indexed<Index>& seeds, int threads,
                         const FractionReport& report) {
  const std::size_t n = graph.size();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Aggregates near{Indexed<Index>(n, -1), Indexed<double>(n, infinity)};
  // Ties go to the lower seed: the first one here.
  for (const Index s : indicesOf(seeds)) {
    near.of_node[seeds[s]] = s;
    near.distances[seeds[s]] = 0.0;
    for (const std::size_t e : graph.entries(seeds[s])) {
      const Index j = graph.neighbors[e];
      if (graph.lengths[e] < near.distances[j]) {
        near.distances[j] = graph.lengths[e];
        near.of_node[j] = s;
      }
    }
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

/// Rows of entries that were found block by block.
struct EntryBlock {
  std::vector<std::size_t> ends;  ///< of the rows, from the first entry of the block
  std::vector<Index> columns;
  std::vector<double> values;
};

/// The number of entries of the blocks before each one, and of all.
std::vector<std::size_t> firstEntries(const std::vector<EntryBlock>& blocks) {
  std::vector<std::size_t> first{0};
  for (const EntryBlock& block : blocks)
    first.push_back(first.back() + block.columns.size());
  return first;
}

/// The graph of the aggregates that touch.
Graph coarseGraph(const Graph& graph, const Aggregates& cells, std::size_t count, int threads,
                  const FractionReport& report) {
  const Partition partition(cells.of_node, count);
  reportFraction(report, 0.0);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Scratch {
    Indexed<double> shortest;
    std::vector<Index> touched;
  };
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  std::vector<EntryBlock> blocks((count + kBlockSize - 1) / kBlockSize);
  forEachItem(count, threads, report, [&](std::size_t thread, std::size_t c) {
    auto& [shortest, touched] = scratch[thread];
    shortest.resize(count, infinity);
    touched.clear();
    const auto own = static_cast<Index>(c);
    partition.forEach(own, [&, &shortest = shortest, &touched = touched](Index i) {
      for (const std::size_t e : graph.entries(i)) {
        const Index j = graph.neighbors[e];
        const Index other = cells.of_node[j];
        if (other == own)
          continue;
        if (shortest[other] == infinity)
          touched.push_back(other);
        // The sum of the distances first: the same bits from both sides of the edge. It stays a
        // length where it is beyond the range of double.
        const double length = (cells.distances[i] + cells.distances[j]) + graph.lengths[e];
        shortest[other] = std::min({shortest[other], length, std::numeric_limits<double>::max()});
      }
    });
    std::sort(touched.begin(), touched.end());
    EntryBlock& block = blocks[c / kBlockSize];
    for (const Index other : touched) {
      block.columns.push_back(other);
      block.values.push_back(std::exchange(shortest[other], infinity));
    }
    block.ends.push_back(block.columns.size());
  });
  const std::vector<std::size_t> first = firstEntries(blocks);
  Graph coarse;
  coarse.offsets.reserve(count + 1);
  coarse.neighbors.reserve(first.back());
  coarse.lengths.reserve(first.back());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (const std::size_t end : blocks[b].ends)
      coarse.offsets.push_back(first[b] + end);
    coarse.neighbors.insert(coarse.neighbors.end(), blocks[b].columns.begin(),
                            blocks[b].columns.end());
    coarse.lengths.insert(coarse.lengths.end(), blocks[b].values.begin(), blocks[b].values.end());
  }
  return coarse;
}

/// Adds an entry to a row that is sorted by seed; of two with the same seed the shorter path stays.
void addPath(std::vector<std::pair<Index, double>>& row, Index seed, double length) {
  auto place = row.end();
  while (place != row.begin() && (place - 1)->first > seed)
    --place;
  if (place != row.begin() && (place - 1)->first == seed)
    (place - 1)->second = std::min((place - 1)->second, length);
  else
    row.emplace(place, seed, length);
}

Eigen::SparseMatrix<double, Eigen::RowMajor, Index> interpolation(const Graph& graph,
                                                                  const Aggregates& cells,
                                                                  std::size_t count, int threads,
                                                                  const FractionReport& report) {
  const std::size_t n = graph.size();
  std::vector<EntryBlock> blocks((n + kBlockSize - 1) / kBlockSize);
  forEachBlock(n, threads, report, [&](std::size_t b, std::size_t begin, std::size_t end) {
    EntryBlock& block = blocks[b];
    // About three entries a row.
    constexpr std::size_t expected = 4 * kBlockSize;
    block.columns.reserve(expected);
    block.values.reserve(expected);
    block.ends.reserve(end - begin);
    std::vector<std::pair<Index, double>> row;  // seed, length of the shortest path
    for (const Index i : NumberRange(static_cast<Index>(begin), static_cast<Index>(end))) {
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
        block.columns.push_back(seed);
        block.values.push_back(weight / sum);
      }
      block.ends.push_back(block.columns.size());
    }
  });
  const std::vector<std::size_t> first = firstEntries(blocks);
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> result(static_cast<Eigen::Index>(n),
                                                             static_cast<Eigen::Index>(count));
  result.resizeNonZeros(static_cast<Eigen::Index>(first.back()));
  forEachBlock(n, threads, [&](std::size_t b, std::size_t begin, std::size_t) {
    const EntryBlock& block = blocks[b];
    for (std::size_t r = 0; r < block.ends.size(); ++r)
      result.outerIndexPtr()[begin + r + 1] = static_cast<Index>(first[b] + block.ends[r]);
    std::copy(block.columns.begin(), block.columns.end(), result.innerIndexPtr() + first[b]);
    std::copy(block.values.begin(), block.values.end(), result.valuePtr() + first[b]);
  });
  return result;
}

HierarchyLevel coarsened(const Graph& graph, std::uint32_t seed, int requested_threads,
                         const FractionReport& report) {
  const int threads = threadCount(requested_threads, graph.size());
  HierarchyLevel level;
  level.seeds = independentSet(graph, seed, threads, report);
  Aggregates cells = geodesicCells(graph, level.seeds, threads, report);
  level.graph = coarseGraph(graph, cells, level.seeds.size(), threads, report);
  level.prolongation = interpolation(graph, cells, level.seeds.size(), threads, report);
  level.aggregate_of = std::move(cells.of_node);
  return level;
}

}  // namespace

GraphHierarchy buildGraphHierarchy(const Graph& graph, std::uint32_t seed, Index coarsest_size,
                                   const Execution& execution) {
  GraphHierarchy hierarchy;
  const Graph* finest = &graph;
  const FractionReport report = reportOf(execution, "embedding");
  while (finest->size() > static_cast<std::size_t>(coarsest_size)) {
    HierarchyLevel level = coarsened(*finest, seed, execution.threads, report);
    // Fewer than 4 nodes cannot be spread over a sphere.
    if (level.graph.size() < 4 || static_cast<double>(level.graph.size()) >
                                      kMaxKeptFraction * static_cast<double>(finest->size()))
      break;
    hierarchy.levels.push_back(std::move(level));
    finest = &hierarchy.levels.back().graph;
  }
  return hierarchy;
}

}  // namespace spherical_param::internal
