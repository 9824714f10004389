#pragma once

#include "neighbor_graph.h"

namespace spherical_param::internal {

/// buildNeighborGraph() with GraphMethod::NearestNeighbors, on checked lists.
NeighborGraph buildNearestNeighborGraph(const Positions& points, const NeighborLists& lists, int k);

}  // namespace spherical_param::internal
