#pragma once

#include "graph.h"
#include "spherical_param/types.h"

#include <optional>

namespace spherical_param::internal {

/// First Betti number (over GF(2)) of the clique complex of a graph's power, in which nodes up to
/// `reach` steps apart are neighbours. Cycles of up to 3 x reach points do not count. A closed
/// surface has two cycles for each handle; b wider openings add b - 1.
///
/// \param reach at least 1.
/// \return unset if there are more than 64 cycles (some 32 handles), or if the power has more than
/// 64
///         neighbours a node on average, unlike a surface.
/// Cost: O(n) for a surface, below 1.2 KB of memory a node.
std::optional<int> countCycles(const Graph& graph, int reach);

}  // namespace spherical_param::internal
