#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Projects points from their centroid onto the unit sphere: the start of the iteration in Figure 3
/// of the paper. A point at the centroid gets a fixed direction.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectFromCentroid(const Positions& points);

/// Directions that are never collapsed, the start of last resort: the rank of a point along the
/// cloud's longest axis gives the height on the sphere (equal areas, Archimedes), the angle around
/// that axis its longitude.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectByRank(const Positions& points);

}  // namespace spherical_param::internal
