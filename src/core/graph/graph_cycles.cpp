#include "graph_cycles.h"

#include "indexed.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// A graph's power, with one number for both entries of an edge.
struct PowerGraph : NeighborRows {
  std::vector<std::uint32_t> edges;        ///< the number of each entry's edge
  std::vector<std::array<Index, 2>> ends;  ///< of each edge
};

/// None if a node has more than 64 neighbours on average, or an edge is stored at one end only. At
/// a reach of 3 there are some 40 on a surface; memory and time grow with the number and its
/// square.
std::optional<PowerGraph> powerOf(const Graph& graph, int reach) {
  PowerGraph power;
  Indexed<Index> seen_from(graph.size(), -1);
  std::vector<Index> disc;
  for (const Index center : graph.nodes()) {
    disc.assign(1, center);
    seen_from[center] = center;
    std::size_t begin = 0;
    for (int step = 0; step < reach; ++step)
      for (const std::size_t end = disc.size(); begin < end; ++begin)
        for (const Index w : graph.row(disc[begin]))
          if (std::exchange(seen_from[w], center) != center)
            disc.push_back(w);
    std::sort(disc.begin() + 1, disc.end());
    power.neighbors.insert(power.neighbors.end(), disc.begin() + 1, disc.end());
    power.endRow();
    if (power.neighbors.size() > 64 * graph.size())
      return std::nullopt;
  }
  power.edges.resize(power.neighbors.size());
  power.ends.reserve(power.neighbors.size() / 2);
  // Each row meets its lower neighbours in their order: the next free entry of theirs is its own.
  Indexed<std::size_t> next(power.offsets.begin(), power.offsets.end() - 1);
  for (const Index v : power.nodes())
    for (const std::size_t e : power.entries(v)) {
      const Index w = power.neighbors[e];
      if (w < v)
        continue;
      // Not so in a graph with edges of one direction.
      if (next[w] == power.end(w) || power.neighbors[next[w]] != v)
        return std::nullopt;
      power.edges[e] = power.edges[next[w]++] = static_cast<std::uint32_t>(power.ends.size());
      power.ends.push_back({v, w});
    }
  return power;
}

/// Values of the edges that sum up to zero around every triangle: a cocycle. The edges of a
/// spanning forest have zero, others follow from the triangles; where nothing follows, an edge gets
/// a symbol of its own, and triangles that do not sum up to zero then show which symbols are not
/// independent. What is left of them is the number of cycles.
class Cocycles {
public:
  explicit Cocycles(const PowerGraph& power)
      : power_(power), known_(power.ends.size(), 0), value_(power.ends.size(), 0),
        edge_to_(power.size(), kNone) {}

  /// \return none if there are more symbols than are kept.
  std::optional<int> count() {
    spanForest();
    std::uint32_t first_unknown = 0;
    for (;;) {
      propagate();
      while (first_unknown < known_.size() && known_[first_unknown] != 0)
        ++first_unknown;
      if (first_unknown == known_.size())
        return symbols_ - relations_;
      if (symbols_ == kMaxSymbols)
        return std::nullopt;
      set(first_unknown, std::uint64_t{1} << symbols_++);
    }
  }

private:
  static constexpr int kMaxSymbols = 64;
  static constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

  void set(std::uint32_t edge, std::uint64_t value) {
    known_[edge] = 1;
    value_[edge] = value;
    pending_.push_back(edge);
  }

  void spanForest() {
    Indexed<char> seen(power_.size(), 0);
    std::vector<Index> queue;
    for (const Index root : power_.nodes()) {
      if (std::exchange(seen[root], 1) != 0)
        continue;
      queue.assign(1, root);
      for (std::size_t i = 0; i < queue.size(); ++i)
        for (const std::size_t e : power_.entries(queue[i]))
          if (std::exchange(seen[power_.neighbors[e]], 1) == 0) {
            set(power_.edges[e], 0);
            queue.push_back(power_.neighbors[e]);
          }
    }
  }

  /// Draws all conclusions from what is known.
  void propagate() {
    while (!pending_.empty()) {
      const std::uint32_t edge = pending_.back();
      pending_.pop_back();
      const auto [a, b] = power_.ends[edge];
      if (marked_ != b)
        mark(a);
      const Index other = marked_ == a ? b : a;
      for (const std::size_t e : power_.entries(other)) {
        const std::uint32_t to_marked = edge_to_[power_.neighbors[e]];
        if (to_marked == kNone)
          continue;
        const std::uint32_t to_other = power_.edges[e];
        if (known_[to_marked] != 0 && known_[to_other] != 0)
          relate(value_[edge] ^ value_[to_marked] ^ value_[to_other]);
        else if (known_[to_marked] != 0)
          set(to_other, value_[edge] ^ value_[to_marked]);
        else if (known_[to_other] != 0)
          set(to_marked, value_[edge] ^ value_[to_other]);
      }
    }
  }

  /// Fills edge_to_. Edges that follow each other mostly have a node in common.
  void mark(Index node) {
    if (marked_ == node)
      return;
    if (marked_ >= 0)
      for (const Index w : power_.row(marked_))
        edge_to_[w] = kNone;
    for (const std::size_t e : power_.entries(node))
      edge_to_[power_.neighbors[e]] = power_.edges[e];
    marked_ = node;
  }

  /// A sum of symbols is zero: one of them is not independent.
  void relate(std::uint64_t sum) {
    for (std::size_t bit = 0; sum != 0 && bit < kMaxSymbols; ++bit) {
      if ((sum >> bit & 1u) == 0)
        continue;
      if (relation_[bit] == 0) {
        relation_[bit] = sum;
        ++relations_;
        return;
      }
      sum ^= relation_[bit];
    }
  }

  const PowerGraph& power_;
  std::vector<char> known_;
  std::vector<std::uint64_t> value_;
  std::vector<std::uint32_t> pending_;
  Index marked_ = -1;
  Indexed<std::uint32_t> edge_to_;  ///< from each node to the marked one, or kNone
  std::array<std::uint64_t, kMaxSymbols> relation_{};  ///< by their lowest symbol
  int symbols_ = 0;
  int relations_ = 0;
};

}  // namespace

std::optional<int> countCycles(const Graph& graph, int reach) {
  const std::optional<PowerGraph> power = powerOf(graph, reach);
  return power ? Cocycles(*power).count() : std::nullopt;
}

}  // namespace spherical_param::internal
