#include "judgement.h"

#include "boundary_loops.h"
#include "point_spread.h"
#include "progress.h"
#include "spherical_param/self_intersection.h"
#include "surface_diagnosis.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace spherical_param::internal {

Surface judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
              const Options& options, const Execution& execution) {
  const FractionReport report = reportOf(execution, "quality");
  Surface result;
  result.triangles = surfaceOf(mesh.mesh);
  result.left_out_triangles = mesh.left_out_triangles;
  result.self_intersections = std::move(mesh.intersecting.pairs);
  result.intersections_are_sampled = mesh.intersecting.is_sample;
  result.openings = mesh.openings.found(points, graph.graph, result.triangles);
  result.has_certain_triangles_only = mesh.has_certain_triangles_only;
  if (result.has_certain_triangles_only)
    for (Opening& opening : result.openings)
      opening.is_filled = !opening.triangles.empty();
  result.topology =
      checkTopology(result.triangles, static_cast<std::size_t>(points.cols()), options.threads);
  if (!result.topology.closed)
    result.boundary = boundaryLoops(result.triangles, static_cast<std::size_t>(points.cols()));
  DiagnosisOptions of_diagnosis;
  of_diagnosis.mark_triangles = options.details;
  result.diagnosis = diagnoseSurface(points, result.triangles, graph.graph, graph.bridges,
                                     result.openings, of_diagnosis, options.threads);
  result.diagnosis.is_one_sided = mesh.openings.isOneSided();
  result.diagnosis.cut_handles = mesh.graph_genus - std::min(mesh.graph_genus, result.genus());
  result.diagnosis.is_on_lines = areOnLines(points, graph.graph);
  for (const StrayPoint& stray : graph.stray_points)
    result.outliers.push_back(stray.point);
  reportFraction(report, 0.5);
  result.measures = measureMesh(points, result.triangles, options.threads);
  reportFraction(report, 0.6);
  reportFraction(report, 0.8);
  if (options.details && mesh.embedding.directions.cols() > 0)
    result.vertex_residuals = tangentialLaplacianLengths(
        graph.graph, mesh.embedding.directions,
        options.method == Method::Paper ? options.paper.weights : EdgeWeights::Adaptive);
  markSelfIntersections(result.self_intersections, result.diagnosis.triangle_marks);
  result.intersecting_triangles = countTriangles(result.self_intersections);
  result.smoothing = mesh.smoothed.report;
  result.smoothed = std::move(mesh.smoothed.points);
  result.sphere = std::move(mesh.embedding.directions);
  result.history = std::move(mesh.embedding.history);
  result.embedding = std::move(mesh.embedding.report);
  // A grid makes steps.
  result.is_noisy = mesh.optimization.is_noisy && !areOnGrid(points);
  const bool is_poor = mesh.optimization.is_noisy || result.intersecting_triangles > 0;
  result.diagnosis.fills_volume = is_poor && fillVolume(points);
  result.is_out_of_time = mesh.optimization.is_out_of_time;
  return result;
}

}  // namespace spherical_param::internal
