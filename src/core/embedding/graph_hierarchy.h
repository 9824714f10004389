#pragma once

#include "graph.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// Nodes of the coarsest level, at most.
inline constexpr Index kTypicalCoarsestSize = 500;

/// A graph of fewer nodes and what joins it to the next finer one.
struct HierarchyLevel {
  Graph graph;                      ///< connected; lengths are those of shortest paths
  std::vector<Index> seeds;         ///< node of the finer graph at which each node of this one sits
  std::vector<Index> aggregate_of;  ///< for each node of the finer graph, the node of this one
  /// Nodes of the finer graph x nodes: interpolation of values from this level. The row of a seed
  /// has one entry; that of another node the seeds of its own and its neighbours' aggregates, in
  /// inverse proportion to the lengths of the paths to them. Entries > 0, rows sum to 1.
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> prolongation;
};

/// Coarser and coarser versions of a graph.
struct GraphHierarchy {
  std::vector<HierarchyLevel> levels;  ///< the first is the next coarser than the graph itself
};

/// Coarsens a graph by geometric clustering: seeds are a maximal independent set in an order that
/// looks random, but comes from the edge lengths alone; each seed's aggregate is its geodesic
/// Voronoi cell; two aggregates are joined if an edge joins nodes of them, by the length of the
/// shortest path from seed to seed through such an edge. The energy of an embedding is then about
/// the same on all levels.
///
/// \param graph connected, with positive edge lengths.
/// \param seed  of the order in which nodes are taken.
/// \param coarsest_size levels are added until one has at most this number of nodes; >= 4.
/// \param execution threads, progress
/// \return the levels, each of some 4 to 5 times fewer nodes than the one before; none for a graph
///         of at most `coarsest_size` nodes. The same for the same seed on every platform and for
///         any number of threads, and, up to ties and rounding, for a moved, turned, scaled or
///         renumbered cloud. A graph of many neighbours a node, far from planar, is coarsened
///         whatever its size.
/// \throw Cancelled. Cost: O(n log n).
GraphHierarchy buildGraphHierarchy(const Graph& graph, std::uint32_t seed,
                                   Index coarsest_size = kTypicalCoarsestSize,
                                   const Execution& execution = {});

}  // namespace spherical_param::internal
