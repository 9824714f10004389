#pragma once

#include "spherical_param/neighbor_graph.h"

namespace spherical_param::internal {

/// buildNeighborGraph() with GraphMethod::LocalDelaunay, on checked lists.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      StarAgreement agreement, const NeighborSearch& search,
                                      const Execution& execution);

}  // namespace spherical_param::internal
