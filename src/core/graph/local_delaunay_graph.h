#pragma once

#include "spherical_param/neighbor_graph.h"

namespace spherical_param::internal {

/// buildNeighborGraph() with GraphMethod::LocalDelaunay, on checked lists.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      StarAgreement agreement, const NeighborSearch& search,
                                      const Execution& execution);

/// The part of each node, or -1, as findParts() defines them. \see partOfNodes
std::vector<Index> partsOfGraph(const Positions& points, const NeighborLists& lists, int min_points,
                                const NeighborSearch& search, const Execution& execution);

}  // namespace spherical_param::internal
