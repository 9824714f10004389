#pragma once

#include "neighbor_graph.h"
#include "spherical_param/types.h"

#include <functional>
#include <vector>

namespace spherical_param::internal {

/// For each point whether it is in the star of one of the given ones (n entries each).
using InStarsOf = std::function<std::vector<char>(const std::vector<char>& given)>;

/// The points that belong to no surface, as findStrayPoints() defines them.
///
/// \param points      3 x n, n >= 1.
/// \param agreed      n nodes: the edges on which both stars agree, rows ascending.
/// \param in_stars_of asked once at most, and not if all points are in one piece.
/// \return ascending by point.
std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const InStarsOf& in_stars_of);

}  // namespace spherical_param::internal
