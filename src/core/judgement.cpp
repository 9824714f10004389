#include "judgement.h"

#include "progress.h"
#include "spherical_param/self_intersection.h"

#include <cstddef>
#include <utility>

namespace spherical_param::internal {

SurfaceDiagnosis diagnose(const Positions& points, const Candidate& mesh,
                          const NeighborGraph& graph, const Options& options) {
  DiagnosisOptions diagnosis;
  diagnosis.mark_triangles = options.details;
  return diagnoseSurface(points, mesh.triangles(), graph.graph, graph.report.bridges, diagnosis,
                         options.threads);
}

Result judge(const Positions& points, BestOfRuns best, const Options& options) {
  const FractionReport report = reportOf(options, "quality");
  Candidate& mesh = best.mesh;
  Result result;
  result.diagnosis = diagnose(points, mesh, best.graph(), options);
  reportFraction(report, 0.5);
  result.measures = measureMesh(points, mesh.triangles(), options.threads);
  reportFraction(report, 0.6);
  result.topology =
      checkTopology(mesh.triangles(), static_cast<std::size_t>(points.cols()), options.threads);
  reportFraction(report, 0.8);
  result.self_intersections = mesh.isSmoothed()
                                  ? findSelfIntersections(points, mesh.triangles(), options)
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
  result.triangles = mesh.triangles();
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
