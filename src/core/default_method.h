#pragma once

#include "graph.h"
#include "meshed_cloud.h"
#include "spherical_param/options.h"
#include "stage_clock.h"
#include "surface_topology.h"

namespace spherical_param::internal {

/// Meshes a graph by Method::Default: embeds it with room for its openings, triangulates the
/// sphere, or several spheres and glues them, and optimises the mesh on the points.
///
/// Handles that are not certain are kept if the mesh with them has clearly less energy than the one
/// without them.
///
/// \param topology its rotation system is taken.
MeshedCloud meshByDefault(const Positions& points, NeighborGraph graph, SurfaceTopology& topology,
                          const Options& options, StageClock& clock);

}  // namespace spherical_param::internal
