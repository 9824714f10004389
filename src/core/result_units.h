#pragma once

#include "consolidation.h"
#include "ordered_points.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Turns a result that was computed on nodes into one on vertices: scaled back to the unit of the
/// input, and with the numbers of the vertices.
void toInput(OrderedPoints& nodes, Surface& result);

/// Turns a result of consolidated points into one of the points before.
void toInput(Consolidation& consolidation, Surface& result);

}  // namespace spherical_param::internal
