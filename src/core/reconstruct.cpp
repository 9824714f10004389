#include "spherical_param/reconstruct.h"

#include "caller_neighbors.h"
#include "exact_predicates.h"
#include "judgement.h"
#include "ordered_points.h"
#include "result_units.h"
#include "retries.h"
#include "spherical_param/errors.h"
#include "stage_clock.h"
#include "warnings.h"

#include <chrono>
#include <functional>
#include <utility>

namespace spherical_param {
namespace {

using internal::BestOfRuns;
using internal::Candidate;
using internal::Neighbors;
using internal::OrderedPoints;
using internal::Plan;
using internal::StageClock;

/// The neighbours of the nodes, for a graph with these options.
using FindNeighbors = std::function<Neighbors(const OrderedPoints&, const Options&)>;

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
  orientOutward(points, mesh.triangles(), mesh.embedding);
  return mesh;
}

/// Runs the method once, and again only where the first mesh is bad although the cloud is not.
BestOfRuns runWithRetries(const OrderedPoints& nodes, const FindNeighbors& find_neighbors,
                          const Options& options, StageClock& clock) {
  BestOfRuns best;
  for (int run = 0; run <= options.retries; ++run) {
    const Plan plan = internal::planOf(run, options);
    NeighborGraph graph = buildGraph(nodes, find_neighbors, plan.options, clock);
    const auto begin = std::chrono::steady_clock::now();
    Candidate mesh = meshGraph(nodes.points, std::move(graph), plan.options, clock);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    best.add(plan.description, std::move(mesh), seconds.count());
    if (best.mesh.isGood() ||
        (run == 0 && !internal::isWorthRetrying(nodes.points, best.mesh, options)))
      break;
  }
  return best;
}

Result run(const Positions& points, const Options& all, const FindNeighbors& find_neighbors) {
  checkOptions(all);
  StageClock clock(all);
  const Options options = clock.optionsOfStages();
  OrderedPoints nodes = clock.time(
      "neighbors", [&] { return internal::orderCheckedPoints(points, options.threads); });
  BestOfRuns best = runWithRetries(nodes, find_neighbors, options, clock);
  Result result = clock.time("quality", [&] {
    Result judged = internal::judge(nodes.points, std::move(best), options);
    internal::toInput(nodes, judged);
    return judged;
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
