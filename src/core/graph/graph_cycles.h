#pragma once

#include "graph.h"
#include "spherical_param/types.h"

#include <optional>

namespace spherical_param::internal {

/// The first Betti number, over two elements, of the clique complex of a graph's power, in which
/// nodes up to `reach` steps apart are neighbours: the number of independent cycles that can
/// neither be shrunk to a point nor moved into each other. Cycles of 3 x reach points or fewer do
/// not count. A closed surface has two for each handle; one with b openings wider than that b - 1
/// more.
///
/// \param reach at least 1.
/// \return none if there may be more than 64, as for some 32 handles and more; if the power's
///         nodes have more than 64 neighbours, on average, so that the graph is not that of a
///         surface; or if an edge is stored at one of its ends only.
/// Cost: O(n) for a surface, below 1.2 KB of memory a node.
std::optional<int> countCycles(const Graph& graph, int reach);

}  // namespace spherical_param::internal
