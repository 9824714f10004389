#include "default_method.h"

#include "embedding.h"
#include "energy_mesh.h"
#include "exact_predicates.h"
#include "face_mesh.h"
#include "glued_spheres.h"
#include "graph_building.h"
#include "mesh_cleaning.h"
#include "mesh_optimization.h"
#include "orientation.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"
#include "view_reconstruction.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// A mesh before the optimisation, and perhaps after.
struct Candidate {
  std::vector<CutLoop> handles;
  std::vector<CutLoop> found;  ///< all handles, if no mesh with them could be made
  Embedding embedding;
  Triangles triangles;
  std::optional<MeshOptimization> optimization;
};

/// Whether more triangles intersect than one of some number.
bool isTangle(const Candidate& candidate, std::size_t of = 1000) {
  return of * countTriangles(candidate.optimization->intersecting.pairs) >
         columnCount(candidate.triangles);
}

bool isBetter(const Candidate& candidate, const Candidate& than) {
  return candidate.optimization->intersecting.areFewerThan(than.optimization->intersecting);
}

class Mesher {
public:
  Mesher(const Positions& points, const Graph& graph, SurfaceTopology& topology,
         const Options& options, StageClock& clock)
      : points_(points), graph_(graph), openings_(topology.openings), options_(options),
        clock_(clock), cutter_(std::in_place, points, graph, topology) {}

  /// The mesh along the first of the further cuts that can be glued, if its handles are certain or
  /// pay; else that of the cuts after it, or the sphere.
  Candidate best() {
    const bool is_first = std::exchange(is_first_, false);
    clock_.begin("openings");
    const std::optional<SurfaceCut> cut = cutter_->next();
    if (!cut) {
      cutter_.reset();
      return sphere();
    }
    std::optional<Candidate> glued = gluedAlong(*cut);
    if (!glued) {
      has_failed_ = has_failed_ || is_first;
      return best();
    }
    double doubtful = 0.0;  // length of the loops of handles that are not certain [steps]
    for (const CutLoop& loop : glued->handles)
      doubtful += loop.certainty < 1.0 ? static_cast<double>(loop.nodes.size()) : 0.0;
    if (doubtful == 0.0 || clock_.remaining() == 0.0) {
      cutter_.reset();
      return std::move(*glued);
    }
    Candidate other = best();
    return pay(*glued, other, doubtful) ? std::move(*glued) : std::move(other);
  }

  void optimize(Candidate& candidate) {
    if (candidate.optimization)
      return;
    Execution execution = clock_.limited();
    // The other half is for the smoothed points, which get an optimisation of their own.
    const bool is_smoothed = options_.smoothing > 0;
    if (is_smoothed && execution.time_limit)
      *execution.time_limit /= 2.0;
    clock_.begin("optimization");
    candidate.optimization = optimizeMesh(
        points_, candidate.triangles, graph_,
        OptimizationOptions{openings_.places(), !is_smoothed, options_.seed, clock_.share()},
        execution);
  }

  /// Takes the mesh of the faces of the graph if the best one is a tangle and that one is less.
  void untangle(Candidate& best) {
    // So many intersections cost more than handles that are cut.
    constexpr std::size_t unusable_of = 100;
    if (!isTangle(best) || !clock_.hasTimeAgain())
      return;
    clock_.begin("openings");
    const std::optional<FaceMesh> faces =
        meshFaces(points_, graph_, best.handles.size(), clock_.execution());
    if (!faces)
      return;
    Candidate other;
    other.embedding = best.embedding;
    other.triangles = withAllNodes(points_, graph_, faces->triangles);
    if (other.triangles.cols() == best.triangles.cols())
      other.handles = best.handles;
    else if (!isTangle(best, unusable_of))
      return;
    orientOutward(points_, other.triangles, other.embedding);
    optimize(other);
    if (!isBetter(other, best))
      return;
    has_failed_ = has_failed_ || other.handles.size() < best.handles.size();
    best = std::move(other);
  }

  /// Whether no mesh with all handles could be made.
  bool hasFailed() const { return has_failed_; }

private:
  /// Whether the handles of a mesh that are not certain pay: it has less energy than one without
  /// them, when its edges are flipped or, if that does not decide, when it is optimised.
  ///
  /// \param steps length of their loops.
  bool pay(Candidate& cut, Candidate& other, double steps) {
    // Of 238 clouds without handles the false ones that can be glued gain -26 to 38 mean edge
    // lengths for each step of their loops, of 80 with handles the true ones 30 to 5,400. When the
    // meshes are optimised, these are at most 0.8, and at least 8.8.
    constexpr double sure_flipped = 60.0;
    constexpr double min_optimized = 3.0;
    const double flipped = flippedEnergy(other) - flippedEnergy(cut);
    if (flipped <= 0.0 || flipped > sure_flipped * steps)
      return flipped > 0.0;
    optimize(cut);
    optimize(other);
    return energy(other.optimization->triangles) - energy(cut.optimization->triangles) >
               min_optimized * steps &&
           !isBetter(other, cut);
  }

  Candidate sphere() {
    Candidate result;
    clock_.begin("embedding");
    if (auto directions = givenDirections(points_, openings_.unit(), options_))
      result.embedding.directions = std::move(*directions);
    else
      result.embedding = openings_.embedded(points_, graph_, options_, clock_.execution());
    clock_.begin("triangulation");
    result.triangles = triangulateSphere(result.embedding.directions, clock_.execution());
    orientOutward(points_, result.triangles, result.embedding);
    return result;
  }

  std::optional<Candidate> gluedAlong(const SurfaceCut& cut) {
    clock_.begin("embedding");
    std::optional<GluedMesh> mesh;
    for (std::size_t i = 0; !mesh && i < cut.loops.size(); ++i)
      mesh = meshGluedSpheres(graph_.size(), cutter_->along(cut.loops[i]),
                              openings_.embeddedOpenings(), options_, clock_.execution());
    if (!mesh)
      return std::nullopt;
    Candidate result;
    result.handles = cut.handles;
    result.triangles = std::move(mesh->triangles);
    if (cut.has_sphere) {
      result.embedding = openings_.embedded(points_, graph_, options_, clock_.execution());
      if (volumeSign(result.embedding.directions, result.triangles) < 0)
        mirror(result.embedding);
    } else {
      result.embedding.report = std::move(mesh->embedding);
    }
    orientOutward(points_, result.triangles, result.embedding);
    return result;
  }

  /// The energy of a mesh whose edges are flipped.
  double flippedEnergy(const Candidate& candidate) {
    Execution execution = clock_.limited();
    clock_.begin("optimization");
    return energy(flipMesh(points_, candidate.triangles, graph_,
                           {openings_.places(), false, options_.seed}, execution));
  }

  double energy(const Triangles& triangles) const {
    return EnergyMesh(points_, triangles, graph_, 1, openings_.places()).energy();
  }

  const Positions& points_;
  const Graph& graph_;
  const OpenSurface& openings_;
  const Options& options_;
  StageClock& clock_;
  std::optional<SurfaceCutter> cutter_;
  bool is_first_ = true;  ///< no way to cut the surface was tried
  bool has_failed_ = false;
};

/// The mesh with all openings open, from that with filled ones; or that one if it is better.
Candidate meshWithOpenings(const Positions& points, const Graph& graph, SurfaceTopology& topology,
                           const Options& options, StageClock& clock, const Candidate& filled) {
  // If so many triangles intersect, it is the embedding that is wrong.
  constexpr std::size_t folded_of = 10;
  Mesher mesher(points, graph, topology, options, clock);
  Candidate best = filled;
  if (!isTangle(filled, folded_of)) {
    best = mesher.best();
    mesher.optimize(best);
  }
  mesher.untangle(best);
  if (mesher.hasFailed())
    best.found = topology.handles;
  return best;
}

/// \param found all handles; \param kept those of the mesh, some of them in their order.
std::vector<HandleLoop> handlesOf(const Positions& points, const std::vector<CutLoop>& found,
                                  const std::vector<CutLoop>& kept) {
  std::vector<HandleLoop> handles;
  auto next = kept.begin();
  for (const CutLoop& loop : found) {
    HandleLoop& handle = handles.emplace_back();
    handle.loop = loop.nodes;
    handle.certainty = loop.certainty;
    handle.is_cut = next == kept.end() || next->nodes != loop.nodes;
    next += handle.is_cut ? 0 : 1;
    Index from = loop.nodes.back();
    for (const Index to : loop.nodes) {
      handle.center += points.col(to) / static_cast<double>(loop.nodes.size());
      handle.length += edgeLength(points, std::exchange(from, to), to);
    }
  }
  std::stable_partition(handles.begin(), handles.end(),
                        [](const HandleLoop& handle) { return !handle.is_cut; });
  return handles;
}

}  // namespace

MeshedCloud meshByDefault(const Positions& points, NeighborGraph graph, SurfaceTopology& topology,
                          const Options& options, StageClock& clock) {
  const bool removes = removesIntersections(options);
  const bool may_open =
      removes && options.surface == SurfaceMode::Auto && topology.openings.fillsPossible();
  Mesher mesher(points, graph.graph, topology, options, clock);
  Candidate best = mesher.best();
  mesher.optimize(best);
  if (removes && !may_open)
    mesher.untangle(best);
  if (mesher.hasFailed())
    best.found = topology.handles;
  if (may_open && isTangle(best) && clock.hasTimeAgain()) {
    // Over a possible opening the surface may be wrong.
    Options open = options;
    open.surface = SurfaceMode::Open;
    SurfaceTopology other =
        findTopology(points, graph.graph, false, topology.openings.unit(), open, clock);
    Candidate with_openings = meshWithOpenings(points, graph.graph, other, open, clock, best);
    if (isBetter(with_openings, best)) {
      best = std::move(with_openings);
      topology = std::move(other);
    }
  }
  MeshedCloud mesh;
  mesh.graph = std::move(graph);
  mesh.handles = handlesOf(points, best.found.empty() ? best.handles : best.found, best.handles);
  mesh.embedding = std::move(best.embedding);
  mesh.optimization = std::move(*best.optimization);
  return mesh;
}

}  // namespace spherical_param::internal
