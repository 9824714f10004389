#pragma once

#include "graph.h"
#include "tangent_stars.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Takes a cloud apart into its surfaces: the connected components of the agreed graph.
///
/// A component of fewer than `min_points` nodes is no part. Each node of it belongs to the part
/// beside it if that has it in a star, or is no farther than the mean distance of neighbours there
/// and 6 times the roughness, and to no part otherwise.
///
/// No guarantees: surfaces that touch are one part, and sparse stray points may form a part.
///
/// \param points 3 x n, the nodes.
/// \param agreed see agreedGraph().
/// \param stars  of the nodes.
/// \return n entries: the part of each node, a node of it; -1: none.
std::vector<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                           std::size_t min_points);

}  // namespace spherical_param::internal
