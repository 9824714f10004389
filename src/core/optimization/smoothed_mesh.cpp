#include "smoothed_mesh.h"

#include "energy_mesh.h"
#include "spherical_param/self_intersection.h"
#include "time_left.h"

#include <utility>

namespace spherical_param::internal {

SmoothedMesh smoothMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                        const OpenPlaces* openings, const SmoothingOptions& options, bool optimizes,
                        std::uint32_t seed, const Execution& execution) {
  const TimeLeft time_left(execution.time_limit);
  Smoothing smoothing = smoothSurface(points, triangles, options, execution.threads);
  SmoothedMesh result{triangles, std::move(smoothing.points), smoothing.report};
  IntersectingPairs found =
      findIntersections(EnergyMesh(result.points, triangles, graph, execution.threads, openings),
                        mostOfUsable(columnCount(triangles)), {});
  if (!found.pairs.empty() && optimizes) {
    Execution rest = execution;
    rest.time_limit = time_left();
    MeshOptimization outcome =
        optimizeMesh(result.points, triangles, graph, {openings, true, seed}, rest);
    result.triangles = std::move(outcome.triangles);
    found = std::move(outcome.intersecting);
    result.is_out_of_time = outcome.report.is_out_of_time;
  }
  result.report.self_intersections = found.pairs.size();
  result.intersecting_triangles = countTriangles(found.pairs);
  result.is_sample = found.is_sample;
  return result;
}

}  // namespace spherical_param::internal
