#pragma once

#include "consolidation.h"
#include "ordered_points.h"
#include "spherical_param/result.h"

#include <vector>

namespace spherical_param::internal {

/// Turns a result that was computed on nodes into one on vertices: scaled back to the unit of the
/// input, and with the numbers of the vertices.
void toInput(OrderedPoints& nodes, Surface& result);

/// Turns a result of consolidated points into one of the points before.
void toInput(Consolidation& consolidation, Surface& result);

/// Turns a surface of some points of a cloud into one in the numbers of the cloud.
///
/// \param inputs the points of the cloud that these are, ascending.
void toCloud(const std::vector<Index>& inputs, Surface& surface);

}  // namespace spherical_param::internal
