#pragma once

#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// Order of points along the Morton curve of their bounding cube (21 bits an axis; G. M. Morton,
/// 1966): points that are near in space are mostly near in the order. Ties go by index.
std::vector<Index> mortonOrder(const Positions& points);

/// Order in which points on the sphere go into a triangulation fast: rounds of growing size, each
/// a random sample of what is left (biased randomised insertion order: N. Amenta, S. Choi and G.
/// Rote, "Incremental constructions con BRIO", 2003), each along a Hilbert curve over the sphere,
/// so that a point is near the one before it. The curve is refined wherever points crowd, to
/// coordinates that differ by one unit in the last place. The same on every platform.
///
/// \param directions 3 x n, unit vectors up to rounding.
std::vector<Index> insertionOrder(const Positions& directions);

}  // namespace spherical_param::internal
