#include "judgement.h"

#include "boundary_loops.h"
#include "point_spread.h"
#include "progress.h"
#include "spherical_param/self_intersection.h"
#include "surface_diagnosis.h"

#include <cstddef>
#include <utility>

namespace spherical_param::internal {

namespace {

/// Diagnoses the cloud by its mesh, its graph and their openings.
SurfaceDiagnosis diagnose(const Positions& points, const Surface& result, const MeshedCloud& mesh,
                          const Options& options) {
  DiagnosisOptions of_diagnosis;
  of_diagnosis.mark_triangles = options.details;
  of_diagnosis.count_cycles = !mesh.optimization.report.is_out_of_time;
  of_diagnosis.genus = static_cast<int>(result.genus());
  return diagnoseSurface(points, result.triangles, mesh.graph.graph, mesh.graph.bridges,
                         result.openings, of_diagnosis, options.threads);
}

}  // namespace

Surface judge(const Positions& points, MeshedCloud mesh, Triangles triangles, bool is_clean,
              const OpenSurface& openings, const Options& options, const Execution& execution) {
  const FractionReport report = reportOf(execution, "quality");
  Surface result;
  result.triangles = std::move(triangles);
  IntersectingPairs found;
  if (!is_clean || mesh.isSmoothed())
    found = findPairsUpTo(mostOfUsable(columnCount(result.triangles)), points, result.triangles,
                          execution);
  result.self_intersections = std::move(found.pairs);
  result.intersections_are_sampled = found.is_sample || mesh.smoothed.is_sample;
  result.openings = openings.found(points, mesh.graph.graph, result.triangles);
  result.has_certain_triangles_only = mesh.has_certain_triangles_only;
  if (result.has_certain_triangles_only)
    for (Opening& opening : result.openings)
      opening.is_filled = !opening.triangles.empty();
  result.topology =
      checkTopology(result.triangles, static_cast<std::size_t>(points.cols()), options.threads);
  if (!result.topology.closed)
    result.boundary = boundaryLoops(result.triangles, static_cast<std::size_t>(points.cols()));
  result.handles = std::move(mesh.handles);
  result.diagnosis = diagnose(points, result, mesh, options);
  if (openings.isOneSided()) {
    result.diagnosis.is_one_sided = true;
    result.diagnosis.kind = SurfaceKind::Unclear;
  }
  result.diagnosis.is_on_lines = areOnLines(points, mesh.graph.graph);
  for (const StrayPoint& stray : mesh.graph.stray_points)
    result.outliers.push_back(stray.point);
  reportFraction(report, 0.5);
  result.measures = measureMesh(points, result.triangles, options.threads);
  reportFraction(report, 0.6);
  reportFraction(report, 0.8);
  if (options.details && mesh.embedding.directions.cols() > 0)
    result.vertex_residuals = tangentialLaplacianLengths(
        mesh.graph.graph, mesh.embedding.directions,
        options.method == Method::Paper ? options.paper.weights : EdgeWeights::Adaptive);
  markSelfIntersections(result.self_intersections, result.diagnosis.triangle_marks);
  result.intersecting_triangles = mesh.isSmoothed() ? mesh.smoothed.intersecting_triangles
                                                    : countTriangles(result.self_intersections);
  result.smoothing = mesh.smoothed.report;
  result.smoothed = std::move(mesh.smoothed.points);
  result.sphere = std::move(mesh.embedding.directions);
  result.history = std::move(mesh.embedding.history);
  result.embedding = std::move(mesh.embedding.report);
  // A grid makes steps.
  result.is_noisy = mesh.optimization.report.is_noisy && !areOnGrid(points);
  const bool is_poor = mesh.optimization.report.is_noisy || result.intersecting_triangles > 0;
  result.diagnosis.fills_volume = is_poor && fillVolume(points);
  result.is_out_of_time = mesh.optimization.report.is_out_of_time;
  return result;
}

}  // namespace spherical_param::internal
