#pragma once

#include "spherical_param/types.h"
#include "stray_points.h"

#include <vector>

namespace spherical_param::internal {

/// The part of each node, as findParts() defines them.
///
/// \param points      3 x n, n >= 1.
/// \param agreed      n nodes: the edges on which both stars agree, rows ascending.
/// \param min_points  nodes of a part at least.
/// \param in_stars_of asked once at most.
/// \return n entries: the lowest node of the part's component; -1: none.
std::vector<Index> partOfNodes(const Positions& points, const Graph& agreed, int min_points,
                               const InStarsOf& in_stars_of);

}  // namespace spherical_param::internal
