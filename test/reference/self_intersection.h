#pragma once

#include "spherical_param/types.h"

#include <array>
#include <vector>

namespace spherical_param::reference {

/// What findSelfIntersections() is to find, from its definition: all pairs of triangles whose
/// bounding boxes overlap, by a sweep along x, and exact predicates for each.
///
/// \param points    3 x n, finite, of extent about 1.
/// \param triangles 3 x m, indices in [0, n).
std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles);

}  // namespace spherical_param::reference
