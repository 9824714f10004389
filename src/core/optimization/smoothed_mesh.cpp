#include "smoothed_mesh.h"

#include "open_mesh.h"
#include "time_left.h"

#include <utility>

namespace spherical_param::internal {

SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const OpenPlaces* openings, const SmoothingOptions& options,
                        OptimizationMethod method, std::uint32_t seed, const Execution& execution) {
  const TimeLeft time_left(execution.time_limit);
  Smoothing smoothing = smoothSurface(points, triangles, options, execution.threads);
  SmoothedMesh result{triangles, std::move(smoothing.points), smoothing.report};
  std::size_t& count = result.report.self_intersections;
  OptimizationOptions none;
  none.method = OptimizationMethod::None;
  count = optimizeMesh(result.points, triangles, graph, openings, none, seed, execution)
              .self_intersections.size();
  if (count > 0 && method == OptimizationMethod::Full) {
    Execution rest = execution;
    rest.time_limit = time_left();
    MeshOptimization outcome =
        optimizeMesh(result.points, triangles, graph, openings, {}, seed, rest);
    result.triangles = std::move(outcome.triangles);
    count = outcome.self_intersections.size();
    result.is_out_of_time = outcome.report.is_out_of_time;
  }
  return result;
}

}  // namespace spherical_param::internal
