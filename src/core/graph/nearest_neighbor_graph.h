#pragma once

#include "neighbor_graph.h"

namespace spherical_param::internal {

/// The nearest-neighbour graph (GraphMethod::NearestNeighbors): points i and j are joined if j is
/// among the k nearest of list i, or i among the k nearest of list j. Components are joined along
/// their minimum spanning tree (Boruvka 1926); otherwise the embedding would collapse.
NeighborGraph buildNearestNeighborGraph(const Positions& points, const NeighborLists& lists, int k);

}  // namespace spherical_param::internal
