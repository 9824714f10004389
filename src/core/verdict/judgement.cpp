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

void judge(const Options& options, Surface& surface) {
  surface.intersecting_triangles = countTriangles(surface.self_intersections);
  surface.topology = checkTopology(surface.triangles, surface.vertexCount(), options.threads);
  if (!surface.topology.closed)
    surface.boundary = boundaryLoops(surface.triangles, surface.vertexCount(), options.threads);
  surface.measures = measureMesh(surface.points, surface.triangles, options.threads);
  if (options.details) {
    std::vector<std::uint8_t>& marks = surface.diagnosis.triangle_marks;
    marks.resize(columnCount(surface.triangles), 0);
    for (const Opening& opening : surface.openings)
      if (opening.isCertain())
        for (const Index t : opening.triangles)
          marks[static_cast<std::size_t>(t)] |= triangle_mark::filled_hole;
    markSelfIntersections(surface.self_intersections, marks);
  }
}

void judge(const Positions& points, const NeighborGraph& graph, PartMesh mesh,
           const Triangles& triangles, const Options& options, const Execution& execution,
           Surface& surface) {
  const FractionReport report = reportOf(execution, "quality");
  DiagnosisOptions of_diagnosis;
  of_diagnosis.mark_triangles = options.details;
  of_diagnosis.may_be_one_sided =
      mesh.openings.isOneSided() &&
      (mesh.mesh.hasOpen() || !surface.self_intersections.empty() || mesh.left_out_triangles > 0);
  surface.diagnosis =
      diagnoseSurface(points, triangles, graph.graph, graph.bridges, of_diagnosis, options.threads);
  reportFraction(report, 0.5);
  judge(options, surface);
  reportFraction(report, 0.8);
  surface.left_out_triangles = mesh.left_out_triangles;
  surface.diagnosis.cut_handles = mesh.cut_handles;
  surface.diagnosis.possible_handles = mesh.possible_handles;
  surface.has_certain_triangles_only = mesh.has_certain_triangles_only;
  for (const StrayPoint& stray : graph.stray_points)
    surface.outliers.push_back(stray.point);
  surface.smoothing = mesh.smoothing;
  // Added vertices have no place on the sphere.
  if (surface.added_vertices == 0 && mesh.embedding.directions.cols() > 0) {
    if (options.details)
      surface.vertex_residuals = tangentialLaplacianLengths(
          graph.graph, mesh.embedding.directions,
          options.method == Method::Paper ? options.paper.weights : EdgeWeights::Adaptive);
    surface.sphere = std::move(mesh.embedding.directions);
  }
  surface.embedding = std::move(mesh.embedding.report);
  // The steps of a grid look like noise.
  surface.is_noisy = mesh.optimization.is_noisy && !areOnGrid(points);
}

}  // namespace spherical_param::internal
