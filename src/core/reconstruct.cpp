#include "spherical_param/reconstruct.h"

#include "caller_neighbors.h"
#include "exact_predicates.h"
#include "ordered_points.h"
#include "result_units.h"
#include "retries.h"
#include "smoothed_mesh.h"
#include "stage_clock.h"
#include "warnings.h"
#include "spherical_param/errors.h"
#include "spherical_param/self_intersection.h"

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

namespace spherical_param {
namespace {

using internal::Neighbors;
using internal::OrderedPoints;
using internal::Plan;
using internal::StageClock;

/// Self-intersections for each triangle up to which retries are worth it even if the cloud does not
/// look like a closed surface.
constexpr double kMaxIntersections = 0.001;

/// The neighbours of the nodes, for a graph with these options.
using FindNeighbors = std::function<Neighbors(const OrderedPoints&, const Options&)>;

/// The mesh of one run. Vertices are nodes, in units of the nodes.
struct Candidate {
  NeighborGraph graph;
  Embedding embedding;
  TriangulationReport triangulation;
  MeshOptimization optimization;
  internal::SmoothedMesh smoothed;  ///< empty without smoothing

  bool isSmoothed() const { return smoothed.points.cols() > 0; }
  const Triangles& triangles() const {
    return isSmoothed() ? smoothed.triangles : optimization.triangles;
  }
  /// Pairs of triangles on the points that were asked for.
  std::size_t intersections() const {
    return isSmoothed() ? smoothed.report.self_intersections
                        : optimization.self_intersections.size();
  }
  /// Noise excuses self-intersections if there are none without it.
  bool isGood() const {
    const OptimizationReport& report = optimization.report;
    return intersections() == 0 ||
           (!isSmoothed() && report.noise_steps > 0 && report.smoothed_self_intersections == 0);
  }
  std::pair<std::size_t, double> badness() const {
    return {intersections(), optimization.report.energy};
  }
};

/// Turns sphere and triangles inside out if the embedding is a mirror image, so that the triangles
/// face outward on both. Exactly: the volume of a cloud that is nearly flat may be all rounding.
void orientOutward(const Positions& points, Triangles& triangles, Embedding& embedding) {
  if (internal::volumeSign(points, triangles) >= 0)
    return;
  flipOrientation(triangles);
  embedding.directions = -embedding.directions;
  for (HistoryFrame& frame : embedding.history.frames)
    frame.sphere = -frame.sphere;
}

NeighborGraph buildGraph(const OrderedPoints& nodes, const FindNeighbors& find_neighbors,
                         const Options& options, StageClock& clock) {
  const Neighbors neighbors =
      clock.time("neighbors", [&] { return find_neighbors(nodes, options); });
  return clock.time("graph", [&] {
    return buildNeighborGraph(nodes.points, neighbors.lists, options.graph, neighbors.search,
                              options);
  });
}

/// The method: embed the graph, triangulate the sphere, optimise the mesh on the points.
Candidate meshGraph(const Positions& points, NeighborGraph graph, const Options& options,
                    StageClock& clock) {
  Candidate mesh;
  mesh.graph = std::move(graph);
  mesh.embedding = clock.time("embedding", [&] {
    return embed(mesh.graph.graph, points, options.embedding, options.seed, options);
  });
  SphereTriangulation triangulation = clock.time("triangulation", [&] {
    return triangulateSphere(mesh.embedding.directions, options.triangulation, options);
  });
  mesh.triangulation = triangulation.report;
  orientOutward(points, triangulation.triangles, mesh.embedding);
  mesh.optimization = clock.time("optimization", [&] {
    return optimizeMesh(points, triangulation.triangles, mesh.graph.graph, options.optimization,
                        options.seed, options);
  });
  if (options.smoothing.steps > 0)
    mesh.smoothed = clock.time("smoothing", [&] {
      return internal::smoothMesh(points, mesh.optimization.triangles, mesh.graph.graph,
                                  options.smoothing, options.optimization.method, options.seed,
                                  options);
    });
  orientOutward(points, mesh.isSmoothed() ? mesh.smoothed.triangles : mesh.optimization.triangles,
                mesh.embedding);
  return mesh;
}

SurfaceDiagnosis diagnose(const Positions& points, const Candidate& mesh,
                          const NeighborGraph& graph, const Options& options) {
  DiagnosisOptions diagnosis;
  diagnosis.mark_triangles = options.details;
  return diagnoseSurface(points, mesh.triangles(), graph.graph, graph.report.bridges, diagnosis,
                         options.threads);
}

/// Whether retries may come to a better mesh: not if the cloud is no closed surface, unless little
/// is wrong.
bool isWorthRetrying(const Positions& points, const Candidate& mesh, const Options& options) {
  return options.optimization.method == OptimizationMethod::Full && options.retries > 0 &&
         !mesh.isGood() &&
         (static_cast<double>(mesh.intersections()) <=
              kMaxIntersections * static_cast<double>(mesh.triangles().cols()) ||
          diagnose(points, mesh, mesh.graph, options).looksClosedGenus0());
}

/// The best mesh of all runs, and the first graph, by which the cloud is judged.
struct Best {
  Candidate mesh;
  std::optional<NeighborGraph> first_graph;  ///< unless it is that of the mesh

  const NeighborGraph& graph() const { return first_graph ? *first_graph : mesh.graph; }
};

/// Runs the method once, and again only where the first mesh is bad although the cloud is not.
Best runWithRetries(const OrderedPoints& nodes, const FindNeighbors& find_neighbors,
                    const Options& options, StageClock& clock, std::vector<RunReport>& runs) {
  Best best;
  for (int run = 0;; ++run) {
    const Plan plan = internal::planOf(run, options);
    NeighborGraph graph = buildGraph(nodes, find_neighbors, plan.options, clock);
    const auto begin = std::chrono::steady_clock::now();
    Candidate mesh = meshGraph(nodes.points, std::move(graph), plan.options, clock);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    const bool is_better = run == 0 || mesh.badness() < best.mesh.badness();
    runs.push_back({plan.description, mesh.intersections(), mesh.optimization.report.energy,
                    seconds.count(), false});
    if (is_better) {
      if (run > 0 && !best.first_graph)
        best.first_graph = std::move(best.mesh.graph);
      best.mesh = std::move(mesh);
      for (RunReport& report : runs)
        report.chosen = &report == &runs.back();
    }
    if (run == 0 && !isWorthRetrying(nodes.points, best.mesh, options))
      return best;
    if (run >= options.retries || best.mesh.isGood())
      return best;
  }
}

/// Measures and diagnoses the mesh, and takes over everything that is known of it.
void judge(const Positions& points, Best& best, const Options& options, Result& result) {
  Candidate& mesh = best.mesh;
  result.diagnosis = diagnose(points, mesh, best.graph(), options);
  result.measures = measureMesh(points, mesh.triangles(), options.threads);
  result.topology =
      checkTopology(mesh.triangles(), static_cast<std::size_t>(points.cols()), options.threads);
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
  result.smoothing = mesh.smoothed.report;
  result.triangles = mesh.triangles();
  result.smoothed = std::move(mesh.smoothed.points);
  result.sphere = std::move(mesh.embedding.directions);
  result.history = std::move(mesh.embedding.history);
  result.graph = std::move(mesh.graph.report);
  result.embedding = std::move(mesh.embedding.report);
  result.triangulation = mesh.triangulation;
  result.optimization = std::move(mesh.optimization.report);
}

Result run(const Positions& points, const Options& options, const FindNeighbors& find_neighbors) {
  checkOptions(options);
  Result result;
  StageClock clock(options);
  OrderedPoints nodes = clock.time(
      "neighbors", [&] { return internal::orderCheckedPoints(points, options.threads); });
  Best best = runWithRetries(nodes, find_neighbors, options, clock, result.runs);
  clock.time("quality", [&] {
    judge(nodes.points, best, options, result);
    internal::toInput(nodes, result);
    return true;
  });
  if (!result.topology.isSphere())
    throw ComputeError("reconstruct: the mesh is not a closed genus-0 manifold; please report "
                       "this cloud as a defect of the library");
  result.stages = clock.take();
  result.warnings = internal::warningsOf(options, result);
  return result;
}

}  // namespace

Result reconstruct(const Positions& points, const Options& options) {
  return run(points, options, [](const OrderedPoints& nodes, const Options& of_run) {
    return internal::nearestNeighbors(nodes, neighborsToSearch(of_run.graph), of_run);
  });
}

Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options,
                   const NeighborSearch& search) {
  return run(points, options, [&](const OrderedPoints& nodes, const Options&) {
    return internal::callerNeighbors(nodes, lists, search);
  });
}

}  // namespace spherical_param
