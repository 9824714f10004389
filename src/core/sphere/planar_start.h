#pragma once

#include "graph.h"

#include <vector>

namespace spherical_param::internal {

/// Nodes near the middle of a graph, the least eccentric first, by the shortest paths to a few
/// distant landmarks.
std::vector<Index> centralNodes(const Graph& graph);

/// An unfolded start for the embedding of a graph: a planar embedding of the graph with three nodes
/// around `center` as its outer face (W. T. Tutte: "How to Draw a Graph", 1963; weights 1 /
/// length), lifted to the sphere by the inverse stereographic projection and centred there by
/// conformal maps. Conductances fall along the paths from the outer face so that limbs do not
/// shrink.
///
/// \return 3 x n unit vectors.
Positions planarStart(const Graph& graph, Index center);

}  // namespace spherical_param::internal
