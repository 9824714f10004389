#include "cycle_labels.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

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
    const Label bit = ~used_ & (used_ + 1);  // the lowest that is free
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
  }
  // The cells of each edge.
  Indexed<std::size_t> next(graph_.ends.size() + 1, 0);
  for (const Index e : edges_of_cell_.neighbors)
    ++next[e + 1];
  for (std::size_t e = 0; e < graph_.ends.size(); ++e)
    next[e + 1] += next[e];
  cells_of_edge_.offsets.assign(next.begin(), next.end());
  cells_of_edge_.neighbors.resize(edges_of_cell_.neighbors.size());
  for (const Index cell : edges_of_cell_.nodes())
    for (const Index e : edges_of_cell_.row(cell))
      cells_of_edge_.neighbors[next[e]++] = cell;
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
    if (--unknown_in_cell_[static_cast<std::size_t>(cell)] > 1)
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

/// A sum of bits is zero: one of them is not independent.
void CycleLabels::relate(Label sum) {
  for (int bit = 0; sum != 0 && bit < kBits; ++bit) {
    if ((sum >> bit & 1U) == 0)
      continue;
    Label& relation = relation_[static_cast<std::size_t>(bit)];
    if (relation == 0) {
      relation = sum;
      --rank_;
      return;
    }
    sum ^= relation;
  }
}

/// Frees the bits that are not independent.
void CycleLabels::applyRelations() {
  // From the highest on: none has the lowest bit of another one then.
  for (int bit = kBits - 1; bit >= 0; --bit)
    for (int higher = bit + 1; higher < kBits; ++higher)
      if ((relation_[static_cast<std::size_t>(bit)] >> higher & 1U) != 0)
        relation_[static_cast<std::size_t>(bit)] ^= relation_[static_cast<std::size_t>(higher)];
  Label freed = 0;
  for (int bit = 0; bit < kBits; ++bit)
    freed |= relation_[static_cast<std::size_t>(bit)] != 0 ? Label{1} << bit : 0;
  if (freed == 0)
    return;
  for (Label& value : value_) {
    const Label freed_of_value = value & freed;
    for (int bit = 0; bit < kBits && freed_of_value >> bit != 0; ++bit)
      if ((freed_of_value >> bit & 1U) != 0)
        value ^= relation_[static_cast<std::size_t>(bit)];
  }
  used_ &= ~freed;
  relation_.fill(0);
}

}  // namespace spherical_param::internal
