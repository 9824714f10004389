#include "graph_cycles.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The edges of a graph's power, both ways, with one number for both.
struct PowerEdges {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> neighbors;      ///< of each node ascending
  std::vector<std::uint32_t> edges;  ///< the number of each entry's edge
  std::uint32_t count = 0;

  std::size_t nodes() const { return offsets.size() - 1; }
};

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// Neighbours that a node of the power has, on average, of which no more is asked: at a reach of 3
/// it has some 40 on a surface. Memory and time would grow with their number and its square.
constexpr std::size_t kMaxNeighbors = 64;

/// None if there are too many.
std::optional<PowerEdges> powerOf(const Graph& graph, int reach) {
  PowerEdges power;
  std::vector<Index> seen_from(graph.size(), -1);
  std::vector<Index> disc;
  for (std::size_t v = 0; v < graph.size(); ++v) {
    const auto center = static_cast<Index>(v);
    disc.assign(1, center);
    seen_from[v] = center;
    std::size_t begin = 0;
    for (int step = 0; step < reach; ++step)
      for (const std::size_t end = disc.size(); begin < end; ++begin)
        for (std::size_t e = graph.offsets[at(disc[begin])]; e < graph.offsets[at(disc[begin]) + 1];
             ++e) {
          const Index w = graph.neighbors[e];
          if (seen_from[at(w)] != center)
            disc.push_back(w);
          seen_from[at(w)] = center;
        }
    power.neighbors.insert(power.neighbors.end(), disc.begin() + 1, disc.end());
    std::sort(power.neighbors.begin() + static_cast<std::ptrdiff_t>(power.offsets.back()),
              power.neighbors.end());
    power.offsets.push_back(power.neighbors.size());
    if (power.neighbors.size() > kMaxNeighbors * graph.size())
      return std::nullopt;
  }
  power.edges.resize(power.neighbors.size());
  // Each row meets its lower neighbours in their order: the next free entry of theirs is its own.
  std::vector<std::size_t> next(power.offsets.begin(), power.offsets.end() - 1);
  for (std::size_t v = 0; v < power.nodes(); ++v)
    for (std::size_t e = power.offsets[v]; e < power.offsets[v + 1]; ++e) {
      const auto w = at(power.neighbors[e]);
      if (w < v)
        continue;
      // Not so in a graph with edges of one direction.
      if (next[w] == power.offsets[w + 1] || at(power.neighbors[next[w]]) != v)
        return std::nullopt;
      power.edges[e] = power.count;
      power.edges[next[w]++] = power.count++;
    }
  return power;
}

/// Values of the edges that sum up to zero around every triangle: a cocycle. The edges of a
/// spanning forest have zero, others follow from the triangles; where nothing follows, an edge gets
/// a symbol of its own, and triangles that do not sum up to zero then show which symbols are not
/// independent. What is left of them is the number of cycles.
class Cocycles {
public:
  explicit Cocycles(const PowerEdges& power)
      : power_(power), known_(power.count, 0), value_(power.count, 0),
        edge_to_(power.nodes(), kNone) {}

  /// \return none if there are more symbols than are kept.
  std::optional<int> count() {
    spanForest();
    std::uint32_t first_unknown = 0;
    const std::vector<Edge> ends = endsOfEdges();
    for (;;) {
      propagate(ends);
      while (first_unknown < power_.count && known_[first_unknown] != 0)
        ++first_unknown;
      if (first_unknown == power_.count)
        return symbols_ - relations_;
      if (symbols_ == kMaxSymbols)
        return std::nullopt;
      set(first_unknown, std::uint64_t{1} << symbols_++);
    }
  }

private:
  using Edge = std::array<Index, 2>;
  static constexpr int kMaxSymbols = 64;
  static constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

  void set(std::uint32_t edge, std::uint64_t value) {
    known_[edge] = 1;
    value_[edge] = value;
    pending_.push_back(edge);
  }

  void spanForest() {
    std::vector<char> seen(power_.nodes(), 0);
    std::vector<Index> queue;
    for (std::size_t root = 0; root < power_.nodes(); ++root) {
      if (seen[root] != 0)
        continue;
      seen[root] = 1;
      queue.assign(1, static_cast<Index>(root));
      for (std::size_t i = 0; i < queue.size(); ++i)
        for (std::size_t e = power_.offsets[at(queue[i])]; e < power_.offsets[at(queue[i]) + 1];
             ++e) {
          const Index w = power_.neighbors[e];
          if (seen[at(w)] != 0)
            continue;
          seen[at(w)] = 1;
          set(power_.edges[e], 0);
          queue.push_back(w);
        }
    }
  }

  std::vector<Edge> endsOfEdges() const {
    std::vector<Edge> ends(power_.count);
    for (std::size_t v = 0; v < power_.nodes(); ++v)
      for (std::size_t e = power_.offsets[v]; e < power_.offsets[v + 1]; ++e)
        if (at(power_.neighbors[e]) > v)
          ends[power_.edges[e]] = {static_cast<Index>(v), power_.neighbors[e]};
    return ends;
  }

  /// Draws all conclusions from what is known.
  void propagate(const std::vector<Edge>& ends) {
    while (!pending_.empty()) {
      const std::uint32_t edge = pending_.back();
      pending_.pop_back();
      const auto [a, b] = ends[edge];
      if (marked_ != b)
        mark(a);
      const Index other = marked_ == a ? b : a;
      for (std::size_t e = power_.offsets[at(other)]; e < power_.offsets[at(other) + 1]; ++e) {
        const std::uint32_t to_marked = edge_to_[at(power_.neighbors[e])];
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
      for (std::size_t e = power_.offsets[at(marked_)]; e < power_.offsets[at(marked_) + 1]; ++e)
        edge_to_[at(power_.neighbors[e])] = kNone;
    for (std::size_t e = power_.offsets[at(node)]; e < power_.offsets[at(node) + 1]; ++e)
      edge_to_[at(power_.neighbors[e])] = power_.edges[e];
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

  const PowerEdges& power_;
  std::vector<char> known_;
  std::vector<std::uint64_t> value_;
  std::vector<std::uint32_t> pending_;
  Index marked_ = -1;
  std::vector<std::uint32_t> edge_to_;  ///< from each node to the marked one, or kNone
  std::array<std::uint64_t, kMaxSymbols> relation_{};  ///< by their lowest symbol
  int symbols_ = 0;
  int relations_ = 0;
};

}  // namespace

std::optional<int> countCycles(const Graph& graph, int reach) {
  const std::optional<PowerEdges> power = powerOf(graph, reach);
  return power ? Cocycles(*power).count() : std::nullopt;
}

}  // namespace spherical_param::internal
