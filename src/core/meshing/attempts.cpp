#include "attempts.h"

#include "energy_mesh.h"
#include "exact_predicates.h"
#include "face_mesh.h"
#include "filled_graph.h"
#include "mesh_cleaning.h"
#include "mesh_optimization.h"
#include "open_mesh.h"
#include "orientation.h"
#include "sampling_analysis.h"
#include "smoothing.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"
#include "view_search.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The fraction of the energy that handles should save.
constexpr double kMinGain = 0.05;
/// Faces that close up have at most this fraction of triangles that are in no face of the graph.
constexpr double kFewDefects = 0.001;
/// Of faces with more defects, most handles are false.
constexpr double kSomeDefects = 0.02;

/// A finished mesh, and the figures by which it is compared.
struct Outcome {
  PartMesh part;
  std::size_t genus = 0;
  std::size_t left_out = 0;      ///< points and triangles
  std::optional<double> energy;  ///< if it was asked for

  bool isOpen() const { return part.mesh.hasOpen(); }
  std::size_t intersecting() const { return countTriangles(part.intersecting.pairs); }
};

/// A closed mesh before the optimisation.
struct Start {
  SphereMesh mesh;
  std::optional<double> energy;  ///< after flips, which are the first step of the optimisation
};

/// The ways to mesh a part: the rows of a table, in the order in which they are tried.
class Attempts {
public:
  Attempts(const Positions& points, const Graph& graph, SurfacePlan& plan, const Options& options,
           StageClock& clock)
      : points_(points), graph_(graph), plan_(plan), options_(options), clock_(clock) {}

  Outcome run() {
    struct Row {
      bool (Attempts::*is_due)();
      std::optional<Outcome> (Attempts::*mesh)();
    };
    static constexpr Row rows[] = {
        {&Attempts::isNoSurface, &Attempts::meshCertainFaces},
        {&Attempts::areFacesGood, &Attempts::meshFaces},
        {&Attempts::mayBeSphere, &Attempts::meshSphere},
        {&Attempts::mayFacesHelp, &Attempts::meshFaces},
        {&Attempts::areHandlesDoubtful, &Attempts::meshFacesWithoutHandles},
        {&Attempts::mayOpenAll, &Attempts::meshWithAllOpen},
        {&Attempts::mayLeaveOut, &Attempts::meshCertainFaces},
    };
    for (const Row& row : rows) {
      if (best_ && !clock_.hasTimeAgain())
        break;
      if (!(this->*row.is_due)())
        continue;
      std::optional<Outcome> next = (this->*row.mesh)();
      if (next && (!best_ || isBetter(*next, *best_)))
        best_ = std::move(next);
    }
    if (options_.handles == HandleMode::None && clock_.hasTimeAgain() && areHandlesSure())
      best_->part.cut_handles = facesGenus();
    if (mayUseFaces() && mayHaveHandles() && !best_->part.has_certain_triangles_only &&
        facesGenus() > best_->genus && defects() <= kSomeDefects)
      best_->part.possible_handles = facesGenus() - best_->genus;
    takeSphere();
    return std::move(*best_);
  }

private:
  bool mayHaveHandles() const {
    return options_.handles == HandleMode::Auto && !plan_.openings().isOneSided();
  }
  std::size_t facesGenus() { return plan_.faces() != nullptr ? plan_.faces()->genus() : 0; }

  /// Whether no triangles intersect, and nothing is left out.
  bool isSound() const {
    return best_ && best_->part.intersecting.pairs.empty() && best_->left_out == 0;
  }

  /// Of usable meshes the closed one is better, then the one with more handles if these save
  /// energy, else the one with fewer. Of others the one with fewer intersections is better, then
  /// with more points, then with less energy.
  bool isBetter(Outcome& mesh, Outcome& than) {
    if (!removesIntersections(options_) && mesh.left_out != than.left_out)
      return mesh.left_out < than.left_out;
    if (mesh.part.isUsable() && than.part.isUsable()) {
      if (mesh.isOpen() != than.isOpen())
        return than.isOpen();
      if (mesh.genus != than.genus)
        return mesh.genus > than.genus ? doHandlesHelp(mesh, than) : !doHandlesHelp(than, mesh);
    }
    if (mesh.intersecting() != than.intersecting())
      return mesh.intersecting() < than.intersecting();
    return std::pair(mesh.left_out, energyOf(mesh)) < std::pair(than.left_out, energyOf(than));
  }

  /// Whether a mesh is better than another one because it has more handles.
  bool doHandlesHelp(Outcome& mesh, Outcome& than) {
    constexpr double few_points = 0.001;
    constexpr double max_of_doubtful = 0.9;
    const std::size_t few = fractionOf(few_points, graph_.size());
    if (mesh.left_out > than.left_out + few || than.left_out > mesh.left_out + few)
      return mesh.left_out < than.left_out;
    return energyOf(mesh) < (areHandlesSure() ? 1.0 : max_of_doubtful) * energyOf(than);
  }

  // --- 1. The faces of the graph

  bool mayUseFaces() { return !isGiven(options_) && plan_.faces() != nullptr; }

  /// The triangles that are in no face of the graph, without those over openings, as a fraction.
  double defects() {
    const SphereMesh& faces = *plan_.faces();
    auto filling = static_cast<double>(faces.slotCount() - faces.surfaceCount());
    for (const Opening& opening : plan_.openings().embeddedOpenings().openings)
      filling -= static_cast<double>(opening.loop.size()) - 2.0;
    return filling / static_cast<double>(faces.slotCount());
  }

  /// Whether the faces close up with hardly a defect, or have certain handles.
  bool areFacesGood() {
    const bool is_sphere_alone = !removesIntersections(options_) && !mayHaveHandles();
    if (is_sphere_alone || !mayUseFaces() || plan_.openings().isOneSided())
      return false;
    return facesGenus() == 0 ? defects() <= kFewDefects : mayHaveHandles() && areHandlesSure();
  }

  /// Whether the handles of the faces are certain: with them the faces cost less energy than
  /// without, and close up, or have few defects and cost far less energy than the sphere.
  bool areHandlesSure() {
    // Where the faces close up, true handles have at least 1.05, false ones 0.998.
    constexpr double min_of_cut = 1.02;
    constexpr double max_defects = 0.03;
    constexpr double min_of_sphere = 2.1;
    if (!are_handles_sure_)
      are_handles_sure_ = facesGenus() > 0 && defects() <= max_defects &&
                          (!cut() || min_of_cut * flippedEnergy(faces()) < flippedEnergy(*cut())) &&
                          ((cut() && defects() <= kFewDefects) ||
                           min_of_sphere * flippedEnergy(faces()) < flippedEnergy(sphere()));
    return *are_handles_sure_;
  }

  /// The faces without handles; nothing if there are none.
  std::optional<Start>& cut() {
    if (!cut_) {
      cut_.emplace();
      if (const auto mesh = withoutHandles(points_, graph_, *plan_.faces()))
        *cut_ = startOf(*mesh);
    }
    return *cut_;
  }

  Start startOf(const SphereMesh& faces) const {
    Start start{withAllNodes(points_, graph_, faces), {}};
    Embedding none;
    orientOutward(points_, start.mesh, none);
    return start;
  }

  Start& faces() {
    if (!faces_)
      faces_ = startOf(*plan_.faces());
    return *faces_;
  }

  /// Whether a mesh of some energy after flips may be better than the best one.
  bool mayHelp(double energy, std::size_t genus) {
    // The optimisation hardly lowers the energy of a mesh that becomes sound.
    constexpr double max_energy = 1.05;
    const double most = genus == best_->genus ? max_energy : 1.0 - kMinGain;
    return best_->intersecting() > 0 || energy < most * energyOf(*best_);
  }

  bool mayFacesHelp() {
    if (are_faces_tried_ || !mayUseFaces() || (facesGenus() > 0 && !mayHaveHandles()))
      return false;
    // Noise makes false handles.
    constexpr double max_defects = 0.05;
    if (isSound() && (facesGenus() <= best_->genus || defects() > max_defects))
      return false;
    return mayHelp(flippedEnergy(faces()), facesGenus());
  }

  std::optional<Outcome> meshFaces() {
    are_faces_tried_ = true;
    return finished(faces().mesh, {});
  }

  bool areHandlesDoubtful() {
    return mayUseFaces() && facesGenus() > 0 && !(mayHaveHandles() && areHandlesSure()) &&
           (!isSound() || best_->genus > 0);
  }

  std::optional<Outcome> meshFacesWithoutHandles() {
    if (!cut() || !mayHelp(flippedEnergy(*cut()), 0))
      return std::nullopt;
    return finished(cut()->mesh, {});
  }

  // --- 2. The sphere

  bool mayBeSphere() { return !isSound(); }

  /// Gives the best mesh its embedding, if it is wanted and there is one.
  void takeSphere() {
    const bool is_wanted = options_.details || options_.topology == TopologyMode::Sphere ||
                           options_.embedding.tolerance;
    Embedding& embedding = best_->part.embedding;
    if (!is_wanted || best_->genus > 0 || best_->part.has_certain_triangles_only) {
      embedding = {};
    } else if (embedding.directions.cols() == 0) {
      embedding = embedding_.directions.cols() > 0 ? std::move(embedding_) : embeddingOf();
      if (volumeSign(embedding.directions, best_->part.mesh.triangles()) < 0)
        mirror(embedding);
    }
  }

  Start& sphere() {
    if (!sphere_) {
      embedding_ = embeddingOf();
      clock_.begin("triangulation");
      SphereMesh mesh(triangulateSphere(embedding_.directions, clock_.execution()), graph_.size(),
                      clock_.execution().threads);
      orientOutward(points_, mesh, embedding_);
      sphere_ = Start{std::move(mesh), {}};
    }
    return *sphere_;
  }

  /// The embedding of the graph with virtual nodes in the openings.
  Embedding embeddingOf() {
    clock_.begin("embedding");
    Embedding embedding;
    const Openings& openings = plan_.openings().embeddedOpenings();
    const auto embed_graph = [&](const Graph& graph, const Positions& points) {
      return embed(graph, points, options_.embedding, options_.seed, clock_.execution());
    };
    if (auto directions = givenDirections(points_, plan_.openings().unit(), options_)) {
      embedding.directions = std::move(*directions);
    } else if (openings.openings.empty()) {
      embedding = embed_graph(graph_, points_);
    } else {
      const FilledGraph filled = fillOpenings(points_, graph_, openings);
      embedding = embed_graph(filled.graph, filled.points);
      embedding.directions = Positions(embedding.directions.leftCols(points_.cols()));
    }
    return embedding;
  }

  std::optional<Outcome> meshSphere() {
    const SphereMesh& mesh = sphere().mesh;
    return finished(mesh, embedding_);
  }

  // --- 3. All openings open

  bool mayOpenAll() {
    constexpr double few = 0.002;
    return (best_->intersecting() > 0 || best_->left_out > fractionOf(few, graph_.size())) &&
           mayLeaveOutTriangles(options_, best_->part) && options_.surface == SurfaceMode::Auto &&
           plan_.openings().fillsPossible();
  }

  std::optional<Outcome> meshWithAllOpen() {
    Options options = options_;
    options.surface = SurfaceMode::Open;
    SurfacePlan plan(points_, graph_, false, plan_.openings().unit(), options, clock_);
    return Attempts(points_, graph_, plan, options, clock_).run();
  }

  // --- 4. Certain faces

  /// Whether the certain faces are meshed first: other meshes would be tangles, and slow.
  bool isNoSurface() { return !plan_.samplesSurface() && keepsCertainOnly(options_); }

  bool mayLeaveOut() {
    return best_->intersecting() > 0 && options_.smoothing == 0 &&
           mayLeaveOutTriangles(options_, best_->part);
  }

  std::optional<Outcome> meshCertainFaces() {
    if (plan_.faces() == nullptr)
      return std::nullopt;
    std::optional<SphereMesh> faces = *plan_.faces();
    if (!mayHaveHandles())
      faces = withoutHandles(points_, graph_, std::move(*faces));
    Outcome outcome;
    outcome.part.openings = plan_.openings();
    if (best_)
      outcome.part.optimization = best_->part.optimization;
    if (!faces || !takeCertainFaces(points_, *faces, clock_.execution(), outcome.part))
      return std::nullopt;
    outcome.genus = faces->genus();
    return outcome;
  }

  // --- What all of them need

  bool isEven() {
    if (!is_even_) {
      clock_.begin("optimization");
      is_even_ = isEvenlySampled(points_, graph_, clock_.execution().threads);
    }
    return *is_even_;
  }

  double flippedEnergy(Start& start) {
    if (!start.energy) {
      const Execution execution = clock_.limited();
      clock_.begin("optimization");
      start.mesh = flipMesh(points_, std::move(start.mesh), graph_,
                            {plan_.openings().places(), false, options_.seed, isEven()}, execution);
      start.energy = energyOf(start.mesh);
    }
    return *start.energy;
  }

  double energyOf(SphereMesh mesh) const {
    return EnergyMesh(points_, std::move(mesh), graph_, 1, plan_.openings().places()).energy();
  }

  double energyOf(Outcome& outcome) const {
    if (!outcome.energy)  // without the slots of vertices that were taken out
      outcome.energy = energyOf(SphereMesh(outcome.part.mesh.triangles(), graph_.size()));
    return *outcome.energy;
  }

  Outcome finished(SphereMesh mesh, Embedding embedding) {
    Outcome outcome;
    outcome.genus = mesh.genus();
    outcome.part.mesh = std::move(mesh);
    outcome.part.openings = plan_.openings();
    outcome.part.embedding = std::move(embedding);
    finishMesh(points_, graph_, options_, clock_, outcome.part, isEven());
    const SphereMesh& finished = outcome.part.mesh;
    outcome.left_out =
        graph_.size() - finished.surfaceVertexCount() + outcome.part.left_out_triangles;
    return outcome;
  }

  const Positions& points_;
  const Graph& graph_;
  SurfacePlan& plan_;
  const Options& options_;
  StageClock& clock_;
  std::optional<Outcome> best_;
  bool are_faces_tried_ = false;
  std::optional<bool> are_handles_sure_;
  std::optional<bool> is_even_;
  std::optional<Start> faces_;
  std::optional<Start> sphere_;
  std::optional<std::optional<Start>> cut_;  ///< empty: there is none
  Embedding embedding_;
};

}  // namespace

void finishMesh(const Positions& points, const Graph& graph, const Options& options,
                StageClock& clock, PartMesh& part, std::optional<bool> is_even) {
  const OpenPlaces* const places = part.openings.places();
  const bool is_smoothed = options.smoothing > 0;
  const auto optimize = [&](const Positions& at, bool is_last) {
    const std::optional<bool> is_even_there = &at == &points ? is_even : std::nullopt;
    Execution execution = clock.limited();
    // The other half is for the smoothed points, which get an optimisation of their own.
    if (!is_last && execution.time_limit)
      *execution.time_limit /= 2.0;
    MeshOptimization optimized = optimizeMesh(
        at, std::move(part.mesh), graph,
        {places, is_last, options.seed, is_even_there, clock.pointsFraction()}, execution);
    part.mesh = std::move(optimized.mesh);
    part.intersecting = std::move(optimized.intersecting);
    return optimized.report;
  };
  if (options.method == Method::Default) {
    clock.begin("optimization");
    part.optimization = optimize(points, !is_smoothed);
  }
  if (is_smoothed) {
    clock.begin("smoothing");
    Smoothing smoothing =
        smoothSurface(points, part.mesh.triangles(),
                      {SmoothingMethod::Biharmonic, options.smoothing}, clock.execution().threads);
    part.smoothed = std::move(smoothing.points);
    part.smoothing = smoothing.report;
    part.intersecting = findIntersections(
        EnergyMesh(part.smoothed, part.mesh, graph, clock.execution().threads, places),
        mostOfUsable(part.mesh.slotCount()), {});
    if (!part.intersecting.pairs.empty() && options.method == Method::Default &&
        optimize(part.smoothed, true).is_out_of_time)
      part.optimization.is_out_of_time = true;
  }
  clock.begin("cleaning");
  if (places != nullptr)
    openMesh(points, *places, part.mesh);
  cleanMesh(points, options, clock.execution(), part);
}

bool keepsCertainOnly(const Options& options) {
  return mayLeaveOutTriangles(options) && options.smoothing == 0;
}

PartMesh meshByAttempts(const Positions& points, const Graph& graph, SurfacePlan plan,
                        const Options& options, StageClock& clock) {
  return Attempts(points, graph, plan, options, clock).run().part;
}

}  // namespace spherical_param::internal
