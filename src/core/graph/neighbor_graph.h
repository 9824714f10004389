#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <cstddef>
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

/// Report of a neighbour graph.
struct GraphReport {
  std::size_t edges = 0;        ///< undirected edges, bridges included
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< edges that join them, in the order of their insertion

  // Only of GraphMethod::LocalDelaunay. Its bridges also join biconnected components.

  /// Points without a reliable tangent plane, ascending; they have the neighbours of the Gabriel
  /// graph instead.
  std::vector<Index> without_tangent_plane;
  Index searched_again = 0;  ///< points for which more neighbours were searched
  Index uncertified = 0;     ///< points with a tangent plane but without a certified cell
  Index weak = 0;            ///< points with fewer than three agreed edges, repaired
  std::vector<StrayPoint> stray_points;  ///< ascending; also nodes of the graph
};

/// A connected neighbour graph.
struct NeighborGraph {
  Graph graph;         ///< connected
  GraphReport report;  ///< figures of its construction
};

/// @}

}  // namespace spherical_param
