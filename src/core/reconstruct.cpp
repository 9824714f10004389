#include "spherical_param/reconstruct.h"

#include "caller_neighbors.h"
#include "exact_predicates.h"
#include "findings.h"
#include "judgement.h"
#include "open_mesh.h"
#include "open_surface.h"
#include "ordered_points.h"
#include "result_units.h"
#include "sphere_triangulation.h"
#include "spherical_param/errors.h"
#include "stage_clock.h"

#include <cmath>
#include <functional>
#include <utility>

namespace spherical_param {
namespace {

using internal::MeshedCloud;
using internal::Neighbors;
using internal::OpenSurface;
using internal::OrderedPoints;
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

/// Whether the mesh is closed and of genus 0, or that with openings, over all vertices.
bool isAsPromised(const Surface& result) {
  const MeshTopology& topology = result.topology;
  return result.isClosed()
             ? topology.isSphere()
             : topology.manifold() && topology.oriented && topology.faults.unused_vertices.empty();
}

/// Whether the mesh may have openings.
bool mayBeOpen(const Options& options) {
  return options.surface != SurfaceMode::Closed && internal::seeksOpenings(options);
}

[[noreturn]] void refuseFlat(const Options& options) {
  if (mayBeOpen(options))
    throw InvalidInput(
        "reconstruct: all points lie in one plane and form no patch there; give more "
        "points, and not on a line");
  throw InvalidInput("reconstruct: all points lie in one plane; a closed surface needs points "
                     "outside of it, and an open one the surface mode 'open'");
}

NeighborGraph buildGraph(const OrderedPoints& nodes, const FindNeighbors& find_neighbors,
                         const Options& options, StageClock& clock) {
  const Neighbors neighbors =
      clock.time("neighbors", [&] { return find_neighbors(nodes, options); });
  return clock.time("graph", [&] {
    return buildNeighborGraph(nodes.points, neighbors.lists, options.graph,
                              neighborsToSearch(options), neighbors.search, options);
  });
}

OpenSurface findOpenSurface(const OrderedPoints& nodes, const Graph& graph, bool is_flat,
                            const Options& options, StageClock& clock) {
  if (!internal::seeksOpenings(options))
    return {};
  return clock.time("openings", [&] {
    return OpenSurface(nodes.points, graph, is_flat, std::ldexp(1.0, nodes.exponent), options);
  });
}

/// The method: embed the graph, triangulate the sphere, optimise the mesh on the points.
MeshedCloud meshGraph(const Positions& points, NeighborGraph graph, const OpenSurface& surface,
                      const Options& options, StageClock& clock) {
  MeshedCloud mesh;
  mesh.graph = std::move(graph);
  mesh.embedding =
      clock.time("embedding", [&] { return surface.embedded(points, mesh.graph.graph, options); });
  SphereTriangulation triangulation = clock.time("triangulation", [&] {
    return triangulateSphere(mesh.embedding.directions, options.triangulation, options);
  });
  orientOutward(points, triangulation.triangles, mesh.embedding);
  const bool is_smoothed = options.smoothing > 0;
  OptimizationOptions of_optimization;
  of_optimization.method = options.optimization;
  // The smoothed points get an optimisation of their own.
  if (is_smoothed)
    of_optimization.finish_on_points = false;
  Execution execution = options;
  execution.time_limit = clock.remaining();
  // The other half is for the smoothed points.
  if (is_smoothed && execution.time_limit)
    *execution.time_limit /= 2.0;
  mesh.optimization = clock.time("optimization", [&] {
    return internal::optimizeMesh(points, triangulation.triangles, mesh.graph.graph,
                                  surface.places(), of_optimization, options.seed, execution);
  });
  if (is_smoothed) {
    execution.time_limit = clock.remaining();
    mesh.smoothed = clock.time("smoothing", [&] {
      return internal::smoothMesh(points, mesh.optimization.triangles, mesh.graph.graph,
                                  surface.places(),
                                  SmoothingOptions{SmoothingMethod::Biharmonic, options.smoothing},
                                  options.optimization, options.seed, execution);
    });
  }
  bool& is_out_of_time = mesh.optimization.report.is_out_of_time;
  is_out_of_time = is_out_of_time || mesh.smoothed.is_out_of_time;
  orientOutward(points, mesh.triangles(), mesh.embedding);
  return mesh;
}

Neighbors findNeighbors(const OrderedPoints& nodes, const Options& options) {
  return internal::nearestNeighbors(nodes, neighborsToSearch(options), options);
}

Surface run(const Positions& input, const Options& all, const FindNeighbors& find_neighbors) {
  checkOptions(all);
  StageClock clock(all);
  const Options options = clock.optionsOfStages();
  Consolidation consolidation;
  const bool is_consolidated = options.consolidation == ConsolidationMode::Auto;
  if (is_consolidated)
    consolidation = clock.time("consolidation", [&] { return consolidate(input, options); });
  const Positions& points = is_consolidated ? consolidation.points : input;
  OrderedPoints nodes = clock.time(
      "neighbors", [&] { return internal::orderCheckedPoints(points, options.threads); });
  const bool is_flat = areCoplanar(points);
  if (is_flat && !mayBeOpen(options))
    refuseFlat(options);
  NeighborGraph graph = buildGraph(nodes, find_neighbors, options, clock);
  const OpenSurface surface = findOpenSurface(nodes, graph.graph, is_flat, options, clock);
  if (is_flat && !surface.isOpen())
    refuseFlat(options);
  MeshedCloud mesh = meshGraph(nodes.points, std::move(graph), surface, options, clock);
  Surface result = clock.time(
      "quality", [&] { return internal::judge(nodes.points, std::move(mesh), surface, options); });
  if (is_flat && result.isClosed())
    refuseFlat(options);
  internal::toInput(nodes, result);
  if (is_consolidated)
    internal::toInput(consolidation, result);
  if (!isAsPromised(result))
    throw ComputeError("reconstruct: the mesh is no manifold of genus 0; please report this cloud "
                       "as a defect of the library");
  result.stages = clock.take();
  result.findings = internal::findingsOf(options, result);
  result.verdict = internal::verdictOf(options, result);
  return result;
}

}  // namespace

Surface reconstruct(const Positions& points, const Options& options) {
  return run(points, options, findNeighbors);
}

Surface reconstruct(const Positions& points, const NeighborLists& lists, const Options& options,
                    const NeighborSearch& search) {
  if (options.consolidation != ConsolidationMode::None)
    return run(points, options, findNeighbors);
  return run(points, options, [&](const OrderedPoints& nodes, const Options&) {
    return internal::callerNeighbors(nodes, lists, search);
  });
}

}  // namespace spherical_param
