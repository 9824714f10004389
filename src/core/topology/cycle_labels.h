#pragma once

#include "graph.h"
#include "indexed.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace spherical_param::internal {

/// A graph with one number for both entries of an edge.
struct NumberedGraph : NeighborRows {
  std::vector<std::uint32_t> edges;        ///< the number of each entry's edge
  std::vector<std::array<Index, 2>> ends;  ///< of each edge, the lower one first

  /// \param rows every edge at both of its ends.
  explicit NumberedGraph(NeighborRows rows);

  /// The number of the edge of two neighbours.
  std::uint32_t edgeOf(Index v, Index w) const;
};

/// Labels of the edges of a graph that tell which closed walks bound: those whose labels sum up (by
/// exclusive or) to zero. Triangles bound, and further walks that are given as cells. This is a
/// basis of the first cohomology over GF(2), a bit for each cycle: the edges of a spanning forest
/// have zero, others follow from the cells; where nothing follows, an edge gets a bit of its own,
/// and cells that do not sum up to zero then show which bits are not independent.
class CycleLabels {
public:
  using Label = std::uint64_t;

  /// \param cells closed walks: nodes in order.
  CycleLabels(const NumberedGraph& graph, const NeighborRows& cells);

  /// Number of independent cycles, but for those through edges that are left out.
  int rank() const { return rank_; }
  /// Whether no edge is left out.
  bool areComplete() const { return are_complete_; }
  /// Not of an edge that is left out: there are more cycles than bits.
  Label operator[](std::uint32_t edge) const { return value_[edge]; }
  bool isLeftOut(std::uint32_t edge) const { return state_[edge] != State::Known; }
  /// The label of a closed walk.
  Label of(const std::vector<Index>& walk) const;
  /// Takes a label, and its sums with others, for bounding from now on.
  void fill(Label label);

private:
  enum class State : std::uint8_t { Unknown, Known, LeftOut };
  static constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

  void addCells(const NeighborRows& cells);
  void set(std::uint32_t edge, Label value);
  void spanForest();
  void propagate();
  void propagateInTriangles(std::uint32_t edge);
  void propagateInCells(std::uint32_t edge);
  void mark(Index node);
  Label independentBitsOf(Label sum) const;
  void relate(Label sum);
  void applyRelations();

  const NumberedGraph& graph_;
  std::vector<State> state_;
  std::vector<Label> value_;
  std::vector<std::uint32_t> pending_;
  /// The cells: their edges, those of each edge, and how many edges are unknown.
  NeighborRows edges_of_cell_;
  NeighborRows cells_of_edge_;
  Indexed<Index> unknown_in_cell_;
  Index marked_ = -1;
  Indexed<std::uint32_t> edge_to_;  ///< from each node to the marked one, or kNone
  std::vector<Label> relations_;    ///< sums that bound; none has the lowest bit of one before it
  Label used_ = 0;                  ///< bits
  int rank_ = 0;
  bool are_complete_ = true;
};

/// First Betti number (over GF(2)) of the clique complex of a graph's power, in which nodes up to
/// `reach` steps apart are neighbours. Cycles of up to 3 x reach points do not count. A closed
/// surface has two cycles for each handle; b wider openings add b - 1.
///
/// \param reach at least 1.
/// \return unset if there are more than 64 cycles (some 32 handles), or if the power has more than
///         64 neighbours a node on average, unlike a surface.
/// Cost: O(n) for a surface, below 1.2 KB of memory a node.
std::optional<int> countCycles(const Graph& graph, int reach);

}  // namespace spherical_param::internal
