#pragma once

#include "rows.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// Undirected graph in compressed rows: every edge is stored at both of its ends.
/// Rows are sorted by ascending neighbour, without repetition and without self-loops.
struct Graph : internal::NeighborRows {
  /// Euclidean length of each entry's edge [unit of the input]: finite and > 0, or 0 by rounding.
  std::vector<double> lengths;

  /// Number of undirected edges. \return half the number of entries
  std::size_t edgeCount() const { return neighbors.size() / 2; }
  /// Lengths of the edges of a node.
  internal::Row<double> lengthsOf(Index node) const {
    return {lengths.data() + begin(node), lengths.data() + end(node)};
  }
};

/// An edge that joins two components of a graph.
struct Bridge {
  Index from;     ///< node in one component
  Index to;       ///< node in the other component
  double length;  ///< distance of the two points [unit of the input]
};

/// A point that belongs to no surface. \see internal::strayPoints
struct StrayPoint {
  Index point;      ///< its index
  double distance;  ///< to the nearest surface [mean distance of neighbours there]
};

/// A connected neighbour graph.
struct NeighborGraph {
  Graph graph;
  /// The edges that join its components, in the order of their insertion. Those of the tangent
  /// Delaunay graph also join biconnected components.
  std::vector<Bridge> bridges;
  /// Ascending; they are nodes of the graph as well. Only the tangent Delaunay graph has them.
  std::vector<StrayPoint> stray_points;
};

}  // namespace spherical_param
