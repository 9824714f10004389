#include "judgement.h"

#include "boundary_loops.h"
#include "point_spread.h"
#include "progress.h"
#include "spherical_param/self_intersection.h"
#include "surface_diagnosis.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace spherical_param::internal {

Surface judge(FinishedMesh mesh, SurfaceDiagnosis diagnosis, const Options& options) {
  Surface result;
  result.points = std::move(mesh.points);
  result.triangles = std::move(mesh.triangles);
  result.input_of_vertex = std::move(mesh.input_of_vertex);
  result.added_vertices = mesh.added_vertices;
  result.smoothly_filled = mesh.smoothly_filled;
  result.faced_by = mesh.faced_by;
  result.openings = std::move(mesh.openings);
  result.self_intersections = std::move(mesh.intersecting.pairs);
  result.intersecting_triangles = countTriangles(result.self_intersections);
  result.intersections_are_sampled = mesh.intersecting.is_sample;
  result.is_out_of_time = mesh.is_out_of_time;
  result.topology = checkTopology(result.triangles, result.vertexCount(), options.threads);
  if (!result.topology.closed)
    result.boundary = boundaryLoops(result.triangles, result.vertexCount(), options.threads);
  result.measures = measureMesh(result.points, result.triangles, options.threads);
  result.diagnosis = std::move(diagnosis);
  if (options.details) {
    std::vector<std::uint8_t>& marks = result.diagnosis.triangle_marks;
    marks.resize(columnCount(result.triangles), 0);
    for (const Opening& opening : result.openings)
      if (opening.isCertain())
        for (const Index t : opening.triangles)
          marks[static_cast<std::size_t>(t)] |= triangle_mark::filled_hole;
    markSelfIntersections(result.self_intersections, marks);
  }
  return result;
}

Surface judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
              const Triangles& triangles, FinishedMesh finished, const Options& options,
              const Execution& execution) {
  const FractionReport report = reportOf(execution, "quality");
  DiagnosisOptions of_diagnosis;
  of_diagnosis.mark_triangles = options.details;
  of_diagnosis.may_be_one_sided =
      mesh.openings.isOneSided() &&
      (mesh.mesh.hasOpen() || !finished.intersecting.pairs.empty() || mesh.left_out_triangles > 0);
  SurfaceDiagnosis diagnosis = diagnoseSurface(points, triangles, graph.graph, graph.bridges,
                                               finished.openings, of_diagnosis, options.threads);
  reportFraction(report, 0.5);
  Surface result = judge(std::move(finished), std::move(diagnosis), options);
  reportFraction(report, 0.8);
  result.left_out_triangles = mesh.left_out_triangles;
  result.diagnosis.cut_handles = mesh.cut_handles;
  result.diagnosis.possible_handles = mesh.possible_handles;
  result.has_certain_triangles_only = mesh.has_certain_triangles_only;
  for (const StrayPoint& stray : graph.stray_points)
    result.outliers.push_back(stray.point);
  result.smoothing = mesh.smoothing;
  // Added vertices have no place on the sphere.
  if (result.added_vertices == 0 && mesh.embedding.directions.cols() > 0) {
    if (options.details)
      result.vertex_residuals = tangentialLaplacianLengths(
          graph.graph, mesh.embedding.directions,
          options.method == Method::Paper ? options.paper.weights : EdgeWeights::Adaptive);
    result.sphere = std::move(mesh.embedding.directions);
  }
  result.embedding = std::move(mesh.embedding.report);
  // A grid makes steps.
  result.is_noisy = mesh.optimization.is_noisy && !areOnGrid(points);
  return result;
}

}  // namespace spherical_param::internal
