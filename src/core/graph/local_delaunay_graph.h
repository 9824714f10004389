#pragma once

#include "neighbor_graph.h"
#include "stray_points.h"

namespace spherical_param::internal {

/// buildNeighborGraph() with GraphMethod::LocalDelaunay, on checked lists.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      const NeighborSearch& search, const Execution& execution);

/// The edges on which both stars agree, before anything is repaired or joined.
struct AgreedGraph {
  Graph graph;
  InStarsOf in_stars_of;
};

/// \param points 3 x n, n >= 1.
AgreedGraph agreedGraph(const Positions& points, const NeighborLists& lists,
                        const NeighborSearch& search, const Execution& execution);

}  // namespace spherical_param::internal
