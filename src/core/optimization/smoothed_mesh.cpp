#include "smoothed_mesh.h"

#include "optimization_constants.h"
#include "spherical_param/self_intersection.h"

#include <limits>
#include <utility>

namespace spherical_param::internal {
SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const SmoothingOptions& options, OptimizationMethod method,
                        std::uint32_t seed, const Execution& execution) {
  const bool is_full = method == OptimizationMethod::Full;
  SmoothedMesh best;
  best.report.self_intersections = std::numeric_limits<std::size_t>::max();
  Triangles current = triangles;
  for (int round = 0;
       round == 0 || (is_full && round < optimization_constants::kMaxSmoothingRounds); ++round) {
    Smoothing smoothing = smoothSurface(points, current, options, execution.threads);
    std::size_t& count = smoothing.report.self_intersections;
    count = findSelfIntersections(smoothing.points, current, execution).size();
    if (count > 0 && is_full) {
      MeshOptimization outcome = optimizeMesh(smoothing.points, current, graph, {},
                                              seed + static_cast<std::uint32_t>(round), execution);
      current = std::move(outcome.triangles);
      count = outcome.self_intersections.size();
    }
    if (count < best.report.self_intersections)
      best = {current, std::move(smoothing.points), smoothing.report};
    if (best.report.self_intersections == 0)
      break;
  }
  return best;
}

}  // namespace spherical_param::internal
