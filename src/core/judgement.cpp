#include "judgement.h"

#include "boundary_loops.h"
#include "open_mesh.h"
#include "progress.h"
#include "spherical_param/self_intersection.h"

#include <cstddef>
#include <utility>

namespace spherical_param::internal {

Triangles surfaceOf(const Positions& points, const OpenSurface& openings, Candidate& mesh) {
  if (!openings.isOpen())
    return mesh.triangles();
  OpenMesh open = openMesh(points, mesh.triangles(), *openings.places());
  Triangles surface = surfaceOf(open);
  mesh.triangles() = std::move(open.triangles);
  return surface;
}

SurfaceDiagnosis diagnose(const Positions& points, const Triangles& mesh, std::size_t boundaries,
                          const NeighborGraph& graph, const Options& options) {
  DiagnosisOptions of_diagnosis;
  of_diagnosis.mark_triangles = options.details;
  SurfaceDiagnosis diagnosis = diagnoseSurface(points, mesh, graph.graph, graph.report.bridges,
                                               of_diagnosis, options.threads);
  if (boundaries > 0) {
    diagnosis.boundaries = boundaries;
    if (diagnosis.kind == SurfaceKind::ClosedGenus0)
      diagnosis.kind = SurfaceKind::Open;
    diagnosis.summary = summaryOf(diagnosis);
  }
  return diagnosis;
}

Result judge(const Positions& points, BestOfRuns best, const OpenSurface& openings,
             const Options& options) {
  const FractionReport report = reportOf(options, "quality");
  Candidate& mesh = best.mesh;
  Result result;
  result.triangles = surfaceOf(points, openings, mesh);
  result.openings = openings.found();
  if (openings.isOpen())
    result.boundary = boundaryLoops(result.triangles, static_cast<std::size_t>(points.cols()));
  result.diagnosis =
      diagnose(points, result.triangles, result.boundary.size(), best.graph(), options);
  if (openings.isOneSided()) {
    result.diagnosis.is_one_sided = true;
    result.diagnosis.kind = SurfaceKind::Unclear;
    result.diagnosis.summary = summaryOf(result.diagnosis);
  }
  for (const StrayPoint& stray : best.graph().report.stray_points)
    result.outliers.push_back(stray.point);
  result.diagnosis.outliers = result.outliers.size();
  reportFraction(report, 0.5);
  result.measures = measureMesh(points, result.triangles, options.threads);
  reportFraction(report, 0.6);
  result.topology =
      checkTopology(result.triangles, static_cast<std::size_t>(points.cols()), options.threads);
  reportFraction(report, 0.8);
  result.self_intersections = mesh.isSmoothed() || openings.isOpen()
                                  ? findSelfIntersections(points, result.triangles, options)
                                  : std::move(mesh.optimization.self_intersections);
  if (options.details) {
    result.vertex_residuals =
        tangentialLaplacianLengths(mesh.graph.graph, mesh.embedding.directions,
                                   options.embedding.weights, options.embedding.exponent);
    for (const auto& pair : result.self_intersections)
      for (const Index t : pair)
        result.diagnosis.triangle_marks[static_cast<std::size_t>(t)] |=
            TriangleMarks::self_intersection;
  }
  result.runs = std::move(best.runs);
  result.smoothing = mesh.smoothed.report;
  result.smoothed = std::move(mesh.smoothed.points);
  result.sphere = std::move(mesh.embedding.directions);
  result.history = std::move(mesh.embedding.history);
  result.graph = std::move(mesh.graph.report);
  result.embedding = std::move(mesh.embedding.report);
  result.triangulation = mesh.triangulation;
  result.optimization = std::move(mesh.optimization.report);
  return result;
}

}  // namespace spherical_param::internal
