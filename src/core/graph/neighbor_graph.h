#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <vector>

namespace spherical_param {

/// \addtogroup neighbor_graph
/// @{

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
  /// The edges that join its components, in the order of their insertion. Those of
  /// the tangent Delaunay graph also join biconnected components.
  std::vector<Bridge> bridges;
  /// Ascending; also nodes of the graph. Only of the tangent Delaunay graph.
  std::vector<StrayPoint> stray_points;
};

/// @}

}  // namespace spherical_param
