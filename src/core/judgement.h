#pragma once

#include "retries.h"
#include "spherical_param/reconstruct.h"

namespace spherical_param::internal {

/// Diagnoses the cloud by a candidate and a graph.
SurfaceDiagnosis diagnose(const Positions& points, const Candidate& mesh,
                          const NeighborGraph& graph, const Options& options);

/// Measures, checks and diagnoses the best mesh, and moves it and its reports to the result, which
/// is on nodes and in their unit; \see toInput.
Result judge(const Positions& points, BestOfRuns best, const Options& options);

}  // namespace spherical_param::internal
