#include "cycle_labels.h"

#include "shortest_paths.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {
namespace {

CycleLabels::Label lowestBitOf(CycleLabels::Label label) {
  return label & (~label + 1);
}

/// None if a node has more than 64 neighbours on average. At a reach of 3 there are some 40 on a
/// surface; memory and time grow with the number and its square.
std::optional<NeighborRows> powerOf(const Graph& graph, int reach) {
  NeighborRows power;
  IndexSet seen(graph.size());
  std::vector<Index> disc;
  for (const Index center : graph.nodes()) {
    seen.clear();
    collectDisc(center, reach, graph, seen, disc);
    std::sort(disc.begin() + 1, disc.end());
    power.neighbors.insert(power.neighbors.end(), disc.begin() + 1, disc.end());
    power.endRow();
    if (power.neighbors.size() > 64 * graph.size())
      return std::nullopt;
  }
  return power;
}

}  // namespace

NumberedGraph::NumberedGraph(NeighborRows rows) : NeighborRows(std::move(rows)) {
  edges.resize(neighbors.size());
  ends.reserve(neighbors.size() / 2);
  for (const Index v : nodes())
    for (const std::size_t e : entries(v)) {
      const Index w = neighbors[e];
      if (w > v) {
        edges[e] = static_cast<std::uint32_t>(ends.size());
        ends.push_back({v, w});
      } else {
        edges[e] = edgeOf(w, v);
      }
    }
}

std::uint32_t NumberedGraph::edgeOf(Index v, Index w) const {
  std::size_t e = begin(v);
  while (neighbors[e] != w)
    ++e;
  return edges[e];
}

CycleLabels::CycleLabels(const NumberedGraph& graph, const NeighborRows& cells)
    : graph_(graph), state_(graph.ends.size(), State::Unknown), value_(graph.ends.size(), 0),
      edge_to_(graph.size(), kNone) {
  addCells(cells);
  spanForest();
  std::uint32_t first_unknown = 0;
  for (;;) {
    propagate();
    while (first_unknown < state_.size() && state_[first_unknown] != State::Unknown)
      ++first_unknown;
    if (first_unknown == state_.size())
      break;
    if (~used_ == 0)
      applyRelations();
    if (~used_ == 0) {
      state_[first_unknown] = State::LeftOut;
      are_complete_ = false;
      continue;
    }
    const Label bit = lowestBitOf(~used_);
    used_ |= bit;
    ++rank_;
    set(first_unknown, bit);
  }
  applyRelations();
}

CycleLabels::Label CycleLabels::of(const std::vector<Index>& walk) const {
  Label sum = 0;
  Index from = walk.back();
  for (const Index to : walk)
    sum ^= value_[graph_.edgeOf(std::exchange(from, to), to)];
  return sum;
}

void CycleLabels::fill(Label label) {
  relate(label);
  applyRelations();
}

void CycleLabels::addCells(const NeighborRows& cells) {
  std::vector<Index> edges;
  std::vector<Index> cell_of_entry;
  for (const Index cell : cells.nodes()) {
    edges.clear();
    Index from = cells.neighbors[cells.end(cell) - 1];
    for (const Index to : cells.row(cell))
      edges.push_back(static_cast<Index>(graph_.edgeOf(std::exchange(from, to), to)));
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (i + 1 < edges.size() && edges[i] == edges[i + 1])
        ++i;  // there and back
      else
        edges_of_cell_.neighbors.push_back(edges[i]);
    unknown_in_cell_.push_back(
        static_cast<Index>(edges_of_cell_.neighbors.size() - edges_of_cell_.offsets.back()));
    edges_of_cell_.endRow();
    cell_of_entry.resize(edges_of_cell_.neighbors.size(), cell);
  }
  cells_of_edge_ = nodesOfParts(edges_of_cell_.neighbors, graph_.ends.size());
  for (Index& cell : cells_of_edge_.neighbors)
    cell = cell_of_entry[static_cast<std::size_t>(cell)];
}

void CycleLabels::set(std::uint32_t edge, Label value) {
  state_[edge] = State::Known;
  value_[edge] = value;
  pending_.push_back(edge);
}

void CycleLabels::spanForest() {
  Indexed<char> seen(graph_.size(), 0);
  std::vector<Index> queue;
  for (const Index root : graph_.nodes()) {
    if (std::exchange(seen[root], 1) != 0)
      continue;
    queue.assign(1, root);
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const std::size_t e : graph_.entries(queue[i]))
        if (std::exchange(seen[graph_.neighbors[e]], 1) == 0) {
          set(graph_.edges[e], 0);
          queue.push_back(graph_.neighbors[e]);
        }
  }
}

/// Draws all conclusions from what is known.
void CycleLabels::propagate() {
  while (!pending_.empty()) {
    const std::uint32_t edge = pending_.back();
    pending_.pop_back();
    propagateInTriangles(edge);
    propagateInCells(edge);
  }
}

void CycleLabels::propagateInTriangles(std::uint32_t edge) {
  const auto [a, b] = graph_.ends[edge];
  if (marked_ != b)
    mark(a);
  const Index other = marked_ == a ? b : a;
  for (const std::size_t e : graph_.entries(other)) {
    const std::uint32_t to_marked = edge_to_[graph_.neighbors[e]];
    if (to_marked == kNone)
      continue;
    const std::uint32_t to_other = graph_.edges[e];
    const bool knows_marked = state_[to_marked] == State::Known;
    const bool knows_other = state_[to_other] == State::Known;
    if (knows_marked && knows_other)
      relate(value_[edge] ^ value_[to_marked] ^ value_[to_other]);
    else if (knows_marked && state_[to_other] == State::Unknown)
      set(to_other, value_[edge] ^ value_[to_marked]);
    else if (knows_other && state_[to_marked] == State::Unknown)
      set(to_marked, value_[edge] ^ value_[to_other]);
  }
}

void CycleLabels::propagateInCells(std::uint32_t edge) {
  for (const Index cell : cells_of_edge_.row(static_cast<Index>(edge))) {
    if (--unknown_in_cell_[cell] > 1)
      continue;
    Label sum = 0;
    std::uint32_t unknown = kNone;
    for (const Index e : edges_of_cell_.row(cell)) {
      const auto of_cell = static_cast<std::uint32_t>(e);
      if (state_[of_cell] == State::Known)
        sum ^= value_[of_cell];
      else
        unknown = of_cell;
    }
    if (unknown == kNone)
      relate(sum);
    else if (state_[unknown] == State::Unknown)
      set(unknown, sum);
  }
}

/// Fills edge_to_. Edges that follow each other mostly have a node in common.
void CycleLabels::mark(Index node) {
  if (marked_ == node)
    return;
  if (marked_ >= 0)
    for (const Index w : graph_.row(marked_))
      edge_to_[w] = kNone;
  for (const std::size_t e : graph_.entries(node))
    edge_to_[graph_.neighbors[e]] = graph_.edges[e];
  marked_ = node;
}

/// A label by the bits that are independent.
CycleLabels::Label CycleLabels::independentBitsOf(Label sum) const {
  for (const Label relation : relations_)
    if ((sum & lowestBitOf(relation)) != 0)
      sum ^= relation;
  return sum;
}

/// A sum of bits is zero: its lowest one is not independent.
void CycleLabels::relate(Label sum) {
  if (sum != 0)
    sum = independentBitsOf(sum);
  if (sum == 0)
    return;
  relations_.push_back(sum);
  --rank_;
}

/// Frees the bits that are not independent.
void CycleLabels::applyRelations() {
  if (relations_.empty())
    return;
  for (Label& value : value_)
    value = independentBitsOf(value);
  for (const Label relation : relations_)
    used_ &= ~lowestBitOf(relation);
  relations_.clear();
}

std::optional<int> countCycles(const Graph& graph, int reach) {
  std::optional<NeighborRows> power = powerOf(graph, reach);
  if (!power)
    return std::nullopt;
  const NumberedGraph numbered(std::move(*power));
  const CycleLabels labels(numbered, {});
  return labels.areComplete() ? std::optional(labels.rank()) : std::nullopt;
}

}  // namespace spherical_param::internal
