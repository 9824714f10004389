#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup neighbor_graph
/// @{

/// An edge that joins two parts of a graph that was in pieces.
struct Bridge {
  Index from;     ///< node in one part
  Index to;       ///< node in the other part
  double length;  ///< distance of the two points [unit of the input]
};

/// A point that belongs to no surface. \see internal::strayPoints
struct StrayPoint {
  Index point;      ///< its number
  double distance;  ///< to the nearest surface [mean distance of neighbours there]
};

/// What it took to connect a neighbour graph.
struct GraphReport {
  std::size_t edges = 0;        ///< undirected edges, bridges included
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< edges that join them, in the order of their insertion

  // Of GraphMethod::LocalDelaunay alone. Its bridges also tie biconnected components together.

  /// Points without a reliable tangent plane, ascending: their neighbours are those of the Gabriel
  /// graph, which needs none.
  std::vector<Index> without_tangent_plane;
  Index searched_again = 0;  ///< points for which more neighbours were searched
  Index uncertified = 0;     ///< points with a tangent plane whose cell is not certified even so
  Index weak = 0;            ///< points of which fewer than three edges were agreed on, repaired
  std::vector<StrayPoint> stray_points;  ///< ascending; nodes of the graph, as all others are
};

/// A connected neighbour graph.
struct NeighborGraph {
  Graph graph;         ///< connected
  GraphReport report;  ///< how it came about
};

/// @}

}  // namespace spherical_param
