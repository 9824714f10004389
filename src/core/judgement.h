#pragma once

#include "part_mesh.h"
#include "open_surface.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Measures, checks and diagnoses a mesh. The result is on nodes and in their unit, \see toInput.
///
Surface judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
              const Options& options, const Execution& execution);

}  // namespace spherical_param::internal
