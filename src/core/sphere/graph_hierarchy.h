#pragma once

#include "graph.h"
#include "spherical_param/execution.h"

#include <Eigen/SparseCore>

#include <cstdint>
#include <deque>

namespace spherical_param::internal {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;

/// A coarse graph and its relation to the next finer graph.
struct HierarchyLevel {
  Graph graph;  ///< connected; lengths are those of shortest paths
  /// Nodes of the finer graph x nodes: interpolation of values from this level. The row of a seed
  /// has one entry. Other rows have entries for the seeds of the aggregates of the node and its
  /// neighbours, in inverse proportion to the lengths of the paths. Entries > 0, rows sum to 1.
  SparseRows prolongation;
};

/// Coarser and coarser versions of a graph.
struct GraphHierarchy {
  /// Finest first, without the graph itself. A deque, since moving a sparse matrix of Eigen copies
  /// it.
  std::deque<HierarchyLevel> levels;
};

/// Coarsens a graph by geometric clustering. Seeds are a maximal independent set in a pseudo-random
/// order that depends only on edge lengths; the aggregate of a seed is its geodesic Voronoi cell.
/// Two aggregates are joined if an edge joins them; its length is the shortest path from seed to
/// seed through such an edge. The energy of an embedding is then about the same on all levels.
///
/// \param graph connected, with positive edge lengths.
/// \param seed  of the order in which nodes are taken.
/// \param coarsest_size levels are added until one has at most this number of nodes; >= 4.
/// \param execution threads, progress
/// \return the levels, each with about a quarter of the nodes of the last; none if the graph has
///         at most `coarsest_size` nodes. The same on every platform and for any number of threads,
///         and, up to ties and rounding, for a moved, turned, scaled or renumbered cloud.
/// \throw Cancelled. Cost: O(n log n).
GraphHierarchy buildGraphHierarchy(const Graph& graph, std::uint32_t seed, Index coarsest_size,
                                   const Execution& execution = {});

}  // namespace spherical_param::internal
