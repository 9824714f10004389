#pragma once

#include "consolidation.h"
#include "ordered_points.h"
#include "spherical_param/result.h"

#include <vector>

namespace spherical_param::internal {

/// Translates a result from nodes to vertices: to the unit of the input and the indices of
/// vertices. Nodes without triangles are no vertices; inputs there get vertex -1.
void toInput(OrderedPoints& nodes, Surface& result);

/// Translates a result from consolidated points to the points before.
void toInput(Consolidation& consolidation, Surface& result);

/// Translates a surface of some points to the indices of the whole cloud.
///
/// \param points   3 x m, those of the surface.
/// \param inputs   their indices in the cloud, ascending.
/// \param unmeshed receives those without a vertex.
void toCloud(const Positions& points, const std::vector<Index>& inputs, Surface& surface,
             std::vector<Index>& unmeshed);

}  // namespace spherical_param::internal
