#include "spherical_param/reconstruct.h"

#include "attempts.h"
#include "cloud_surfaces.h"
#include "consolidation.h"
#include "exact_predicates.h"
#include "findings.h"
#include "judgement.h"
#include "local_delaunay_graph.h"
#include "mesh_cleaning.h"
#include "open_surface.h"
#include "orientation.h"
#include "paper_method.h"
#include "point_spread.h"
#include "power_of_two.h"
#include "result_units.h"
#include "selection.h"
#include "smooth_fill.h"
#include "spherical_param/errors.h"
#include "stage_clock.h"
#include "surface_plan.h"
#include "view_reconstruction.h"
#include "view_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Whether the mesh is a manifold with the boundary that is listed. Openings may divide it.
bool isAsPromised(const Surface& surface) {
  const MeshTopology& topology = surface.topology;
  return surface.isClosed()
             ? topology.closed && topology.isSurface()
             : topology.manifold() && topology.oriented && topology.unused_vertices.empty() &&
                   topology.boundary_loops == surface.boundary.size();
}

/// Whether the mesh may have openings.
bool mayBeOpen(const Options& options) {
  return options.surface != SurfaceMode::Closed && options.method == Method::Default;
}

[[noreturn]] void refuseFlat(const Options& options) {
  if (mayBeOpen(options))
    throw InvalidInput(
        "reconstruct: all points lie in one plane and form no patch there; add points "
        "that are not on a line");
  throw InvalidInput(
      "reconstruct: all points lie in one plane; add points outside of it, or choose "
      "an open surface");
}

/// The graph of a part; takes its agreed graph.
NeighborGraph takeGraph(Neighborhoods& neighborhoods, const Options& options,
                        const Execution& execution) {
  if (options.method == Method::Paper)
    return paper::nearestNeighborGraph(neighborhoods.points(), neighborhoods.neighbors().lists,
                                       options.paper.k);
  // Else they were found, and left out, before.
  std::vector<StrayPoint> stray;
  if (options.outliers == OutlierMode::None)
    stray = strayPoints(neighborhoods.points(), neighborhoods.agreed(), neighborhoods.stars());
  NeighborGraph graph = buildLocalDelaunayGraph(neighborhoods.points(), neighborhoods.stars(),
                                                std::move(neighborhoods.agreed()), execution);
  graph.stray_points = std::move(stray);
  return graph;
}

/// The published method: embed the graph by the iteration, and take the hull.
PartMesh meshAsPublished(const Positions& points, const Graph& graph, const Options& options,
                         StageClock& clock) {
  constexpr double typical_tolerance = 1e-8;
  PartMesh mesh;
  clock.begin("embedding");
  mesh.embedding =
      paper::embed(graph, points, options.paper,
                   options.embedding.tolerance.value_or(typical_tolerance), clock.execution());
  clock.begin("triangulation");
  mesh.mesh = SphereMesh(paper::convexHull(mesh.embedding.directions, clock.execution()),
                         graph.size(), clock.execution().threads);
  orientOutward(points, mesh.mesh, mesh.embedding);
  clock.begin("quality");
  mesh.intersecting = findPairsUpTo(mostOfUsable(mesh.mesh.slotCount()), points,
                                    mesh.mesh.triangles(), clock.execution());
  finishMesh(points, graph, options, clock, mesh);
  return mesh;
}

/// Meshes a graph of points, and judges the mesh.
///
/// \param is_flat all points are in one plane.
Surface meshGraph(const Positions& points, const NeighborGraph& graph, SurfacePlan plan,
                  bool is_flat, const CloudInfo& info, const Options& options, StageClock& clock) {
  if (is_flat && !plan.openings().isOpen())
    refuseFlat(options);
  clock.keep(options.fill == FillMode::Smooth ? kTimeForFill : 0.0);
  PartMesh mesh = options.method == Method::Paper
                      ? meshAsPublished(points, graph.graph, options, clock)
                      : meshByAttempts(points, graph.graph, std::move(plan), options, clock);
  clock.keep(0.0);
  Surface surface;
  surface.faced_by = orient(points, info, mesh.mesh, mesh.embedding);
  const Triangles triangles = mesh.mesh.surfaceTriangles();
  surface.points = mesh.isSmoothed() ? mesh.smoothed : points;
  surface.triangles = triangles;
  surface.input_of_vertex.resize(columnCount(points));
  std::iota(surface.input_of_vertex.begin(), surface.input_of_vertex.end(), Index{0});
  surface.is_out_of_time = mesh.optimization.is_out_of_time;
  surface.self_intersections = std::move(mesh.intersecting.pairs);
  surface.intersections_are_sampled = mesh.intersecting.is_sample;
  surface.openings = mesh.openings.found(points, graph.graph, triangles);
  if (mesh.has_certain_triangles_only)
    for (Opening& opening : surface.openings)
      opening.is_filled = !opening.triangles.empty();
  if (options.fill == FillMode::Smooth) {
    clock.begin("fill");
    fillSmoothly(clock.limited(), surface);
  }
  clock.begin("quality");
  judge(points, graph, std::move(mesh), triangles, options, clock.execution(), surface);
  return surface;
}

/// coarseSteps(), which do not matter in an elevation grid.
Eigen::Vector3d coarseStepsOffGrid(const Positions& points, double min_spacings) {
  const Eigen::Vector3d steps = coarseSteps(points, min_spacings);
  return steps.isZero(0.0) || isElevationGrid(points) ? Eigen::Vector3d(0.0, 0.0, 0.0) : steps;
}

/// Whether coordinates have steps so coarse that they leave rows of points, not a surface.
bool areRows(const Positions& points) {
  constexpr double min_spacings = 1.0;
  return !coarseStepsOffGrid(points, min_spacings).isZero(0.0);
}

/// Remarks on a part that is no plain surface: what it is, and what becomes of it.
void remarkOn(PointSpread spread, bool are_rows, bool is_on_lines, const Options& options,
              StageClock& clock) {
  const char* const what = spread == PointSpread::Volume   ? "a volume, without a surface"
                           : spread == PointSpread::Layers ? "layers of voxels, without a surface"
                           : spread == PointSpread::Curves ? "curves, without a surface"
                           : are_rows ? "rows of points: single precision lost digits"
                                      : nullptr;
  if (what != nullptr)
    clock.remark(std::string(what) +
                 (keepsCertainOnly(options)
                      ? "; triangles that are certain are kept, if they are enough"
                      : "; its triangles will intersect"));
  else if (is_on_lines)
    clock.remark("lines of points; the surface between them is a guess");
}

/// Meshes the points of a part as they are, with those that were left out and belong to it.
Surface meshAsIs(Selection& selection, std::size_t part, const Options& options,
                 StageClock& clock) {
  // Graph and topology are made anew with the points that were added. Real scans take up to 3
  // rounds.
  constexpr int max_rounds = 5;
  for (int round = 1;; ++round) {
    Neighborhoods& neighborhoods = selection.neighborhoodsOf(part);
    const bool is_flat = internal::areCoplanar(selection.pointsOf(part));
    if (is_flat && !mayBeOpen(options))
      refuseFlat(options);
    NeighborGraph graph = takeGraph(neighborhoods, options, clock.execution());
    OrderedPoints& nodes = neighborhoods.nodes();
    const bool is_scattered = areScattered(nodes.points, neighborhoods.stars());
    neighborhoods.release();
    // Only the tangent Delaunay graph shows openings.
    SurfacePlan plan = options.method == Method::Default
                           ? SurfacePlan(nodes.points, graph.graph, is_flat,
                                         std::ldexp(1.0, nodes.exponent), options, clock)
                           : SurfacePlan();
    if (round < max_rounds &&
        selection.complete(part, nodes, plan.openings().embeddedOpenings().openings))
      continue;
    // Without a surface no attempt makes a good mesh, and some take minutes.
    const PointSpread spread = spreadOf(nodes.points);
    const bool are_rows = areRows(nodes.points);
    const bool is_on_lines = areOnLines(nodes.points, graph.graph);
    remarkOn(spread, are_rows, is_on_lines, options, clock);
    const bool is_surface = spread == PointSpread::Surface && !are_rows;
    if (!is_surface) {
      plan.setNoSurface();
      clock.endPart();
    }
    CloudInfo info = selection.infoOf(part);
    if (info.normals.cols() > 0)
      info.normals = Positions(info.normals(Eigen::all, nodes.input_of_node));
    if (info.viewpoint)
      info.viewpoint = timesPowerOfTwo(*info.viewpoint, -nodes.exponent);
    Surface surface =
        meshGraph(nodes.points, graph, std::move(plan), is_flat, info, options, clock);
    if (is_flat && surface.isClosed())
      refuseFlat(options);
    SurfaceDiagnosis& diagnosis = surface.diagnosis;
    diagnosis.fills_volume = spread == PointSpread::Volume;
    diagnosis.is_layered = spread == PointSpread::Layers;
    diagnosis.is_on_curves = spread == PointSpread::Curves;
    diagnosis.is_on_lines = is_on_lines;
    diagnosis.is_scattered = is_scattered && surface.is_noisy;
    surface.is_out_of_time = surface.is_out_of_time && (is_surface || options.time_limit);
    toInput(nodes, surface);
    return surface;
  }
}

/// Moves the points of a part to the surface that they sample, and meshes them.
Surface meshConsolidated(Selection& all, std::size_t part, const Options& options,
                         StageClock& clock) {
  all.release();
  const CloudInfo info = all.infoOf(part);
  clock.begin("consolidation");
  Consolidation consolidation = consolidate(all.pointsOf(part), clock.execution());
  CloudInfo merged;
  merged.viewpoint = info.viewpoint;
  if (info.normals.cols() > 0)
    merged.normals = Positions::Zero(3, consolidation.points.cols());
  for (Eigen::Index i = 0; i < info.normals.cols(); ++i)
    merged.normals.col(consolidation.point_of_input[static_cast<std::size_t>(i)]) +=
        info.normals.col(i);
  Options as_is = options;
  as_is.outliers = OutlierMode::None;
  as_is.parts = PartsMode::All;
  LeftOut none;
  const NeighborSearchFactory by_tree;
  Selection selection(consolidation.points, as_is, by_tree, merged, clock, none);
  Surface surface = meshAsIs(selection, 0, options, clock);
  toInput(consolidation, surface);
  constexpr double most = 0.95;
  surface.consolidation->distance_95 =
      distanceWithin(most, all.pointsOf(part), surface.vertex_of_input, surface.points,
                     surface.triangles, options.threads);
  return surface;
}

/// Whether a part is a surface with too much noise for a mesh through its points.
bool isNoisySurface(Selection& selection, std::size_t part, StageClock& clock) {
  const Neighborhoods& cloud = selection.neighborhoodsOf(part);
  clock.begin("consolidation");
  return isNoisy(cloud.points(), cloud.neighbors(), cloud.stars(), clock.execution()) &&
         spreadOf(cloud.points()) == PointSpread::Surface;
}

Surface meshPart(Selection& selection, std::size_t part, const Options& options, StageClock& clock,
                 LeftOut& left_out) {
  const bool is_noisy = options.consolidation == ConsolidationMode::AsTopology &&
                        isNoisySurface(selection, part, clock);
  if (is_noisy)
    clock.remark("noisy; points move to the surface that they sample, and merge");
  const bool is_consolidated = is_noisy || options.consolidation == ConsolidationMode::Auto;
  auto* const mesh = is_consolidated ? meshConsolidated : meshAsIs;
  Surface surface = mesh(selection, part, options, clock);
  if (!isAsPromised(surface))
    throw ComputeError(
        "reconstruct: the mesh is not the manifold that was promised; please report this cloud "
        "as a defect of the library");
  toCloud(selection.pointsOf(part), selection.parts()[part], surface, left_out.unmeshed);
  return surface;
}

/// Leaves out the surfaces that are not usable, if the others have a third of the points.
///
/// \param failed receives their points.
void leaveOutUnusable(Result& result, std::vector<Index>& failed) {
  constexpr double min_kept = 1.0 / 3.0;
  const auto is_unusable = [](const Surface& surface) {
    return !surface.isUsable() && !surface.is_out_of_time;
  };
  std::vector<Surface>& surfaces = result.surfaces;
  std::vector<Index> dropped;
  std::size_t unusable = 0;
  std::size_t kept = 0;
  for (const Surface& surface : surfaces)
    if (is_unusable(surface)) {
      dropped.insert(dropped.end(), surface.inputs.begin(), surface.inputs.end());
      ++unusable;
    } else {
      kept += surface.inputs.size();
    }
  if (unusable == 0 ||
      static_cast<double>(kept) < min_kept * static_cast<double>(kept + dropped.size()))
    return;
  surfaces.erase(std::remove_if(surfaces.begin(), surfaces.end(), is_unusable), surfaces.end());
  result.failures.push_back(
      failureOf(unusable, dropped.size(), "more than 1 % of the triangles intersect"));
  failed.insert(failed.end(), dropped.begin(), dropped.end());
}

/// Meshes all parts, each within its fraction of the time. Leaves out the parts that cannot be
/// meshed, unless it is all of them.
void meshParts(Selection& selection, const Options& options, StageClock& clock, Result& result) {
  const std::vector<std::vector<Index>>& parts = selection.parts();
  if (parts.empty())
    throw InvalidInput(
        "reconstruct: no part has min_points = " + std::to_string(options.min_points) +
        " points; give a lower min_points, or parts = all");
  std::size_t left = 0;
  for (const std::vector<Index>& part : parts)
    left += part.size();
  const auto all = static_cast<double>(left);
  std::exception_ptr first_error;
  std::map<std::string, std::array<std::size_t, 2>> failures;  // parts and points of each reason
  std::vector<Index> failed;  // points of parts that cannot be meshed
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const auto count = static_cast<double>(parts[part].size());
    clock.beginPart(part, parts.size(), count / static_cast<double>(left), count / all);
    left -= parts[part].size();
    const auto leave_out = [&](const std::exception& error) {
      if (!first_error)
        first_error = std::current_exception();
      failed.insert(failed.end(), parts[part].begin(), parts[part].end());
      auto& [count_of, points_of] = failures[error.what()];
      ++count_of;
      points_of += parts[part].size();
    };
    try {
      result.surfaces.push_back(meshPart(selection, part, options, clock, result.left_out));
    } catch (const InvalidInput& error) {
      leave_out(error);
    } catch (const ComputeError& error) {
      leave_out(error);
    }
  }
  if (result.surfaces.empty())
    std::rethrow_exception(first_error);
  for (const auto& [error, counts] : failures)
    result.failures.push_back(failureOf(counts[0], counts[1], error));
  if (removesIntersections(options))
    leaveOutUnusable(result, failed);
  std::vector<Index>& left_out = result.left_out.other_parts;
  left_out.insert(left_out.end(), failed.begin(), failed.end());
  std::sort(left_out.begin(), left_out.end());
  std::sort(result.left_out.unmeshed.begin(), result.left_out.unmeshed.end());
}

/// Adds to the message of a failure what was left out, which may be the cause.
template <typename Work>
auto explained(const LeftOut& left_out, const Work& work) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    const std::string what = left_out.text();
    if (what.empty())
      throw;
    std::string message = error.what();
    message.insert(std::min(message.find("; "), message.size()), " (left out: " + what + ")");
    throw InvalidInput(message);
  }
}

/// The points to mesh, in parts.
std::vector<std::vector<Index>> select(const Positions& points, Options options, PartsMode parts,
                                       LeftOut& left_out) {
  options.time_limit.reset();
  checkOptions(options);
  options.parts = parts;
  options = withTopology(options);
  StageClock clock(options);
  std::vector<std::vector<Index>> selected = explained(
      left_out, [&] { return Selection(points, options, {}, {}, clock, left_out).parts(); });
  clock.take();
  return selected;
}

}  // namespace
}  // namespace spherical_param::internal

namespace spherical_param {

Result reconstruct(const Positions& points, const Options& given,
                   const NeighborSearchFactory& search_of, const CloudInfo& info) {
  // Steps of real scans that still mesh well are up to 0.28 spacings, those that make rows of the
  // points 0.6 to 3.6.
  constexpr double coarse_step = 0.45;
  checkOptions(given);
  if (info.normals.cols() > 0 && info.normals.cols() != points.cols())
    throw InvalidInput("reconstruct: " + std::to_string(info.normals.cols()) + " normals of " +
                       std::to_string(points.cols()) + " points; give one for each, or none");
  const Options options = withTopology(given);
  internal::StageClock clock(options);
  Result result;
  const std::size_t parts = internal::explained(result.left_out, [&] {
    std::optional<internal::SearchedNodes> known;
    if (internal::reconstructView(points, given, info, clock, result, known))
      return result.surfaces.size();
    internal::Selection selection(points, given, search_of, info, clock, result.left_out,
                                  std::move(known));
    internal::meshParts(selection, options, clock, result);
    return selection.parts().size();
  });
  result.stages = clock.take();
  for (Surface& surface : result.surfaces) {
    surface.diagnosis.coarse_steps =
        internal::coarseStepsOffGrid(points(Eigen::all, surface.inputs), coarse_step);
    surface.findings = internal::findingsOf(given, surface);
    surface.verdict = internal::verdictOf(options, surface);
  }
  internal::summarize(parts, result);
  return result;
}

JoinedMesh joined(const Result& result) {
  Eigen::Index vertices = 0;
  Eigen::Index triangles = 0;
  bool has_sphere = true;
  for (const Surface& surface : result.surfaces) {
    vertices += surface.points.cols();
    triangles += surface.triangles.cols();
    has_sphere = has_sphere && surface.sphere.cols() > 0;
  }
  JoinedMesh mesh;
  mesh.points.resize(3, vertices);
  mesh.triangles.resize(3, triangles);
  mesh.sphere.resize(3, has_sphere ? vertices : 0);
  vertices = 0;
  triangles = 0;
  for (const Surface& surface : result.surfaces) {
    const Eigen::Index count = surface.points.cols();
    mesh.points.middleCols(vertices, count) = surface.points;
    if (has_sphere)
      mesh.sphere.middleCols(vertices, count) = surface.sphere;
    mesh.triangles.middleCols(triangles, surface.triangles.cols()) =
        surface.triangles.array() + static_cast<Index>(vertices);
    mesh.input_of_vertex.insert(mesh.input_of_vertex.end(), surface.input_of_vertex.begin(),
                                surface.input_of_vertex.end());
    vertices += count;
    triangles += surface.triangles.cols();
    mesh.is_added.resize(mesh.input_of_vertex.size() - surface.added_vertices, 0);
    mesh.is_added.resize(mesh.input_of_vertex.size(), 1);
  }
  return mesh;
}

std::vector<Index> findOutliers(const Positions& points, const Options& options) {
  LeftOut left_out;
  internal::select(points, options, PartsMode::All, left_out);
  return left_out.outliers;
}

std::vector<std::vector<Index>> findParts(const Positions& points, const Options& options) {
  LeftOut left_out;
  return internal::select(points, options, PartsMode::Each, left_out);
}

}  // namespace spherical_param
