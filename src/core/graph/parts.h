#pragma once

#include "graph.h"
#include "indexed.h"
#include "tangent_stars.h"

#include <cstddef>

namespace spherical_param::internal {

/// Splits a cloud into its surfaces, the connected components of the agreed graph.
///
/// Components of fewer than `min_points` nodes are not parts. Their nodes join the nearest part if
/// one of its stars contains them, or if they are within the mean distance of neighbours there and
/// 6 times the roughness.
///
/// No guarantees: surfaces that touch are one part, and sparse stray points may form a part.
///
/// \param points 3 x n, the nodes.
/// \param agreed see agreedGraph().
/// \param stars  of the nodes.
/// \return n entries: a node that represents the part of each node; -1: no part.
Indexed<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                       std::size_t min_points);

}  // namespace spherical_param::internal
