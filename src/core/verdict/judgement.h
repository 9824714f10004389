#pragma once

#include "part_mesh.h"
#include "smooth_fill.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Measures and checks a mesh. Every surface is written here.
///
/// \param diagnosis of the mesh before triangles were added.
Surface judge(FinishedMesh mesh, SurfaceDiagnosis diagnosis, const Options& options);

/// The same, with a diagnosis by the graph. The result is on nodes and in their unit, \see toInput.
///
/// \param triangles of the mesh on the nodes alone.
/// \param finished  mesh that is written.
Surface judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
              const Triangles& triangles, FinishedMesh finished, const Options& options,
              const Execution& execution);

}  // namespace spherical_param::internal
