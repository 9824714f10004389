#pragma once

#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// Order of points along the Morton curve of their bounding cube (21 bits an axis; G. M. Morton,
/// 1966): points that are near in space are mostly near in the order. Ties go by index.
std::vector<Index> mortonOrder(const Positions& points);

}  // namespace spherical_param::internal
