#pragma once

#include "neighbor_graph.h"

namespace spherical_param::internal {

/// The graph of the k nearest neighbours (GraphMethod::NearestNeighbors): points i and j are joined
/// if j is among the k nearest of list i, or i among the k nearest of list j. Components are then
/// joined along the minimum spanning tree of the components (Boruvka 1926), because a graph in
/// pieces collapses the embedding.
NeighborGraph buildNearestNeighborGraph(const Positions& points, const NeighborLists& lists, int k);

}  // namespace spherical_param::internal
