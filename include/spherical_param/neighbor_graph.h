#pragma once

#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// Parameters of buildNeighborGraph().
struct NeighborGraphOptions {
  /// Nearest neighbours used of each list (k of Zwicker and Gotsman 2004, section 3); lists that
  /// hold fewer are used whole. Range: 3 and up.
  int k = 25;
};

/// An edge that joins two parts of a graph that was in pieces.
struct Bridge {
  Index from;     ///< node in one part
  Index to;       ///< node in the other part
  double length;  ///< distance of the two points [unit of the input]
};

/// A connected neighbour graph, and what it took to connect it.
struct NeighborGraph {
  Graph graph;                  ///< connected
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< components - 1 edges, in the order of their insertion
};

/// Builds the symmetric, connected neighbour graph of a point cloud.
///
/// Points i and j are joined if j is among the k nearest of list i, or i among the k nearest of
/// list j. Components are then joined along the minimum spanning tree of the components (Boruvka's
/// algorithm on a k-d tree), because a graph in pieces collapses the embedding.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists; unsorted, longer or shorter than k, and with the point itself.
/// \throw InvalidInput for sizes that disagree, an index out of range, or k < 3.
/// Cost: O(n k log k) and O(c log c log n) for the bridges of c components, typically.
NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 const NeighborGraphOptions& options = {});

}  // namespace spherical_param
