#pragma once

#include "open_surface.h"
#include "retries.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>

namespace spherical_param::internal {

/// The triangles of a candidate that are not over openings, all if it is closed.
Triangles surfaceOf(const Positions& points, const OpenSurface& openings, const Candidate& mesh);

/// Diagnoses the cloud by a mesh and a graph.
///
/// \param boundaries loops around openings that the mesh leaves open.
SurfaceDiagnosis diagnose(const Positions& points, const Triangles& mesh, std::size_t boundaries,
                          const NeighborGraph& graph, const Options& options);

/// Measures, checks and diagnoses the best mesh, and moves it and its reports to the result, which
/// is on nodes and in their unit; \see toInput.
Result judge(const Positions& points, BestOfRuns best, const OpenSurface& openings,
             const Options& options);

}  // namespace spherical_param::internal
