#pragma once

#include "spherical_param/types.h"

#include <optional>

namespace spherical_param::internal {

/// Number of independent closed ways along the edges of a graph that can neither be shrunk to a
/// point nor moved into each other, where whoever is `reach` steps away is a neighbour and whoever
/// are neighbours of each other in threes span a triangle: the first Betti number over two elements
/// of the clique complex of the graph's power. Ways around 3 x reach points or fewer do not count.
/// A closed surface has two for each handle; one with b openings wider than that b - 1 more.
///
/// \param reach at least 1.
/// \return none if more than 64 are in question, which is said of some 32 handles and more, if the
///         power has more than 64 neighbours a node, on average (there is no surface to be seen),
///         or if an edge is stored at one of its ends only.
/// Cost: O(n) for a surface, below 1.2 KB of memory a node.
std::optional<int> countCycles(const Graph& graph, int reach);

}  // namespace spherical_param::internal
