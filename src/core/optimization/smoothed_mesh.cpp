#include "smoothed_mesh.h"

#include "open_mesh.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace spherical_param::internal {

SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const OpenPlaces* openings, const SmoothingOptions& options,
                        OptimizationMethod method, std::uint32_t seed, const Execution& execution) {
  const auto begin = std::chrono::steady_clock::now();
  Smoothing smoothing = smoothSurface(points, triangles, options, execution.threads);
  SmoothedMesh result{triangles, std::move(smoothing.points), smoothing.report};
  std::size_t& count = result.report.self_intersections;
  OptimizationOptions none;
  none.method = OptimizationMethod::None;
  count = optimizeMesh(result.points, triangles, graph, openings, none, seed, execution)
              .self_intersections.size();
  if (count > 0 && method == OptimizationMethod::Full) {
    Execution rest = execution;
    if (rest.time_limit) {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
      rest.time_limit = std::max(0.0, *rest.time_limit - passed.count());
    }
    MeshOptimization outcome =
        optimizeMesh(result.points, triangles, graph, openings, {}, seed, rest);
    result.triangles = std::move(outcome.triangles);
    count = outcome.self_intersections.size();
    result.is_out_of_time = outcome.report.is_out_of_time;
  }
  return result;
}

}  // namespace spherical_param::internal
