#pragma once

#include "part_mesh.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Measures and checks a surface, and marks its filled holes and intersections.
///
/// \param surface with mesh, openings and self-intersections; receives what follows from these.
void judge(const Options& options, Surface& surface);

/// The same with a diagnosis by the graph, and with what the part says about its mesh. The surface
/// is on nodes and in their unit, \see toInput.
///
/// \param triangles of the mesh on the nodes alone.
void judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
           const Triangles& triangles, const Options& options, const Execution& execution,
           Surface& surface);

}  // namespace spherical_param::internal
