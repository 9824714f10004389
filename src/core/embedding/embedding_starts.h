#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Projects points from their centroid onto the unit sphere: the start of the iteration in Figure 3
/// of the paper, and the embedding where all attempts collapse. A point at the centroid gets a
/// fixed direction.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectFromCentroid(const Positions& points);

}  // namespace spherical_param::internal
