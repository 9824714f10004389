#include "mesh_optimization.h"

#include "mesh_optimizer.h"
#include "open_mesh.h"
#include "optimization_constants.h"
#include "parallel.h"
#include "progress.h"
#include "sampling_analysis.h"
#include "smoothing.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

namespace tuned = internal::optimization_constants;
using internal::MeshOptimizer;
using internal::SurfaceEnergy;
using Bend = SurfaceEnergy::Bend;

/// Work that repairs may take. \see MeshOptimizer::work
std::size_t maxWorkOf(std::size_t points) {
  return tuned::kMaxWork + tuned::kMaxWorkOfPoint * points;
}

SurfaceEnergy energyOf(Bend bend, double mu) {
  SurfaceEnergy energy;
  energy.bend = bend;
  energy.mu = mu;
  return energy;
}

/// The optimiser of a mesh, after checks of the input.
MeshOptimizer checkedOptimizer(const Positions& points, const Triangles& triangles,
                               const Graph& graph, const internal::OpenPlaces* openings,
                               int threads, const internal::FractionReport& report) {
  internal::reportFraction(report, 0.0);
  MeshOptimizer optimizer(points, triangles, graph, threads, report, openings);
  if (!optimizer.mesh().isSphere(threads))
    throw InvalidInput("optimizeMesh: the triangles must be a closed, manifold, consistently "
                       "oriented mesh of genus 0 over all points");
  return optimizer;
}

using Clock = std::chrono::steady_clock;

constexpr double kMaxTimeLimit = 1e9;  ///< [s]

std::optional<Clock::time_point> deadlineOf(const Execution& execution) {
  if (!execution.time_limit)
    return std::nullopt;
  const std::chrono::duration<double> limit(*execution.time_limit);
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
}

class Optimization {
public:
  Optimization(const Positions& points, const Triangles& triangles, const Graph& graph,
               const internal::OpenPlaces* openings, const OptimizationOptions& options,
               std::uint32_t seed, const Execution& execution)
      : graph_(graph), options_(options), threads_(execution.threads),
        report_(internal::reportOf(execution, "optimization")), given_(&points), points_(&points),
        random_(seed), deadline_(deadlineOf(execution)),
        max_work_(maxWorkOf(static_cast<std::size_t>(points.cols()))),
        openings_(openings != nullptr ? std::optional(*openings) : std::nullopt),
        optimizer_(checkedOptimizer(points, triangles, graph, openings_ ? &*openings_ : nullptr,
                                    threads_, report_)) {}

  MeshOptimization run() {
    switch (options_.method) {
    case OptimizationMethod::None:
      optimizer_.setEnergy(energyOf(Bend::Angle, tuned::kMu));
      result_.self_intersections = optimizer_.intersections(report_);
      break;
    case OptimizationMethod::Flips:
      flipFirst();
      result_.self_intersections = optimizer_.intersections(report_);
      break;
    case OptimizationMethod::Full:
      flipFirst();
      runFull();
      break;
    }
    result_.report.energy = optimizer_.energy();
    result_.triangles = optimizer_.mesh().triangles();
    return std::move(result_);
  }

private:
  /// What a phase tried, and how much of it was committed.
  struct Tally {
    std::size_t tried = 0;
    std::size_t moves = 0;
  };

  template <typename Work>
  OptimizationPhase& phase(const char* name, const Work& work) {
    OptimizationPhase phase;
    phase.name = name;
    phase.energy_before = optimizer_.energy();
    const auto begin = Clock::now();
    const Tally tally = work();
    const std::chrono::duration<double> time = Clock::now() - begin;
    phase.tried = tally.tried;
    phase.moves = tally.moves;
    phase.energy = optimizer_.energy();
    phase.seconds = time.count();
    result_.report.phases.push_back(phase);
    return result_.report.phases.back();
  }

  bool isOutOfTime() {
    bool& is_out = result_.report.is_out_of_time;
    is_out = is_out || (deadline_ && Clock::now() >= *deadline_);
    return is_out;
  }

  void flips(const char* name) {
    phase(name, [&] { return Tally{0, optimizer_.flipAll(report_)}; });
  }

  void flipFirst() {
    analyze();
    setFlipEnergy(tuned::kMu);
    flips("flips");
    optimizer_.setEnergy(energyOf(Bend::Angle, tuned::kMu));
  }

  void runFull() {
    std::vector<Index> rough = optimizer_.roughVertices(tuned::kMinSmoothCosine, report_);
    result_.report.rough = static_cast<double>(rough.size()) / static_cast<double>(points_->cols());
    if (result_.report.rough > tuned::kMaxRough && !isOutOfTime())
      rough = beginOnNoise();
    relocate(rough);
    // Where nothing is folded, hardly anything intersects: once after the polish is enough.
    if (recreate())
      untangle();
    const Triangles unpolished = optimizer_.mesh().triangles();
    const bool is_polished = polish();
    // With the first energy: it is what keeps sheets apart.
    optimizer_.setEnergy(energyOf(Bend::Angle, tuned::kMu));
    closeWithoutLoop();
    result_.self_intersections = untangleSurface();
    if (is_polished && !result_.self_intersections.empty())
      rollBackPolish(unpolished);
    if (result_.report.noise_steps > 0)
      endOnNoise();
  }

  /// Open triangles that no loop leads to are part of the surface, and must not intersect it.
  /// Returns whether some were closed.
  bool closeWithoutLoop() {
    if (!openings_)
      return false;
    std::vector<Index> vertices;
    for (const Index t : internal::trianglesWithoutLoop(optimizer_.mesh(), *openings_))
      for (const Index v : cornersOf(t))
        vertices.push_back(v);
    if (!openings_->close(vertices))
      return false;
    optimizer_.setPoints(*points_);
    return true;
  }

  /// untangle(), again as long as that leaves open triangles without a loop.
  std::vector<std::array<Index, 2>> untangleSurface() {
    auto pairs = untangle();
    for (int round = 0; round < tuned::kMaxClosingRounds && closeWithoutLoop(); ++round)
      pairs = untangle();
    return pairs;
  }

  /// Continues on smoothed positions. Returns the rough vertices there.
  std::vector<Index> beginOnNoise() {
    const SmoothingOptions smoothing{SmoothingMethod::Umbrella, tuned::kNoiseSteps, false};
    smoothed_ = smoothSurface(*given_, optimizer_.mesh().triangles(), smoothing, threads_).points;
    result_.report.noise_steps = tuned::kNoiseSteps;
    points_ = &smoothed_;
    optimizer_.setPoints(smoothed_);
    analyze();
    flips("flips");
    return optimizer_.roughVertices(tuned::kMinSmoothCosine, report_);
  }

  /// Untangles on the given points, unless too many triangles intersect there.
  void endOnNoise() {
    points_ = given_;
    optimizer_.setPoints(*points_);
    result_.report.smoothed_self_intersections = result_.self_intersections.size();
    if (!options_.finish_on_points)
      return;
    // The smoothed points may have taken all the work: a few points then stayed tangled.
    max_work_ = optimizer_.work() + maxWorkOf(static_cast<std::size_t>(points_->cols()));
    closeWithoutLoop();
    result_.self_intersections = optimizer_.intersections(report_);
    const auto count = static_cast<double>(result_.self_intersections.size());
    if (count <= std::max(tuned::kMaxFewIntersections,
                          tuned::kMaxFewIntersectionsPerTriangle * optimizer_.mesh().size()))
      result_.self_intersections = untangleSurface();
  }

  /// Reports the fraction of a round's items that are done.
  void reportItem(std::size_t item, std::size_t items, std::size_t between_reports) {
    if (item % between_reports == 0)
      internal::reportFraction(report_, static_cast<double>(item) / static_cast<double>(items));
  }

  void relocate(std::vector<Index> rough) {
    for (int round = 0; round < tuned::kMaxRelocateRounds && !rough.empty() && !isOutOfTime();
         ++round) {
      std::vector<Index> moved;
      phase("relocate", [&] {
        Tally tally;
        for (; tally.tried < rough.size() && !isOutOfTime(); ++tally.tried) {
          reportItem(tally.tried, rough.size(), 256);
          if (optimizer_.relocate(rough[tally.tried]))
            moved.push_back(rough[tally.tried]);
        }
        tally.moves = moved.size();
        return tally;
      });
      if (moved.empty())
        break;
      // Only vertices near those that moved may have become rough.
      rough.clear();
      for (const Index v : moved)
        optimizer_.mesh().forEachAround(v, [&](Index t, int corner) {
          const auto w = static_cast<std::size_t>(optimizer_.mesh().vertex(t, (corner + 1) % 3));
          rough.push_back(v);
          rough.push_back(static_cast<Index>(w));
          for (std::size_t e = graph_.offsets[w]; e < graph_.offsets[w + 1]; ++e)
            rough.push_back(graph_.neighbors[e]);
        });
      std::sort(rough.begin(), rough.end());
      rough.erase(std::unique(rough.begin(), rough.end()), rough.end());
      rough.erase(
          std::remove_if(rough.begin(), rough.end(),
                         [&](Index v) { return !optimizer_.isRough(v, tuned::kMinSmoothCosine); }),
          rough.end());
    }
  }

  /// Returns whether folded edges are left.
  bool recreate() {
    for (int round = 0; round < tuned::kMaxRecreateRounds; ++round) {
      const auto folded = optimizer_.edgesBelow(tuned::kMinUnfoldedCosine);
      if (folded.empty() || !mayRepair())
        return !folded.empty();
      phase("ruin and recreate", [&] {
        Tally tally;
        for (std::size_t i = 0; i < folded.size(); ++i) {
          reportItem(i, folded.size(), 16);
          const auto& [v, w] = folded[i];
          for (std::size_t size = tuned::kMinRuin; size <= tuned::kMaxRuin; size *= 2)
            if (optimizer_.mesh().areJoined(v, w))
              tryPart({v, w}, size, MeshOptimizer::isGain, tally);
        }
        return tally;
      });
    }
    return !optimizer_.edgesBelow(tuned::kMinUnfoldedCosine).empty();
  }

  /// Ruins and recreates a part around some vertices, while work is left.
  void tryPart(const std::vector<Index>& seeds, std::size_t size,
               const std::function<bool(double)>& accept, Tally& tally) {
    if (!mayRepair())
      return;
    const std::vector<Index> part = optimizer_.spread(seeds, size, random_);
    ++tally.tried;
    tally.moves += optimizer_.recreate(part, accept, random_) ? 1 : 0;
  }

  /// The three vertices of a triangle.
  std::array<Index, 3> cornersOf(Index t) const {
    return {optimizer_.mesh().vertex(t, 0), optimizer_.mesh().vertex(t, 1),
            optimizer_.mesh().vertex(t, 2)};
  }

  /// Returns the intersections that are left.
  std::vector<std::array<Index, 2>> untangle() {
    auto pairs = optimizer_.intersections(report_);
    result_.report.phases.back().self_intersections = pairs.size();
    const bool is_noise = points_ == given_ && result_.report.noise_steps > 0;
    const int rounds_by_energy = is_noise ? 0 : tuned::kMaxRoundsByEnergy;
    int idle = 0;
    for (int round = 0; round < tuned::kMaxUntangleRounds && idle < tuned::kMaxIdleRounds &&
                        !pairs.empty() && mayRepair();
         ++round) {
      const bool by_number = round >= rounds_by_energy;
      // Small parts gain more in the same time: large ones once nothing else helps.
      const std::size_t largest =
          by_number ? std::min(tuned::kMaxUntangled, tuned::kMaxFirstUntangled << idle)
                    : tuned::kMaxUntangledByEnergy;
      if (by_number && idle == 0) {
        flipApart(pairs);
        if (pairs.empty())
          break;
      }
      OptimizationPhase& untangled = phase("untangle", [&] {
        Tally tally;
        forEachPair(pairs, [&](const auto& pair, const auto& corners) {
          for (std::size_t size = tuned::kMinUntangled; size <= largest; size *= 2) {
            // A pair that has changed waits for the next round.
            if (!areCornersOf(pair, corners))
              return;
            if (by_number)
              tryByNumber(seedsOf(corners), size, tally);
            else
              tryPart(seedsOf(corners), size, MeshOptimizer::isGain, tally);
          }
        });
        return tally;
      });
      pairs = optimizer_.intersections(report_);
      untangled.self_intersections = pairs.size();
      if (by_number)
        idle = untangled.moves == 0 ? idle + 1 : 0;
    }
    return pairs;
  }

  /// Whether work and time are left.
  bool mayRepair() { return optimizer_.work() < max_work_ && !isOutOfTime(); }

  void flipApart(std::vector<std::array<Index, 2>>& pairs) {
    OptimizationPhase& flipped = phase("flip apart", [&] {
      Tally tally;
      forEachPair(pairs, [&](const auto& pair, const auto& corners) {
        if (!mayRepair() || !areCornersOf(pair, corners))
          return;
        optimizer_.watch(optimizer_.spread(seedsOf(corners), tuned::kFlipRegion, random_));
        ++tally.tried;
        if (optimizer_.flipApart() == 0)
          return;
        ++tally.moves;
        // Flips alone may leave the surface crumpled.
        Tally improved;
        for (std::size_t size = tuned::kMinUntangled; size <= tuned::kMaxFirstUntangled; size *= 2)
          tryByNumber(seedsOf(corners), size, improved);
      });
      return tally;
    });
    pairs = optimizer_.intersections(report_);
    flipped.self_intersections = pairs.size();
  }

  using Corners = std::array<std::array<Index, 3>, 2>;

  template <typename Work>
  void forEachPair(const std::vector<std::array<Index, 2>>& pairs, const Work& work) {
    std::vector<Corners> corners;
    corners.reserve(pairs.size());
    for (const auto& [t, u] : pairs)
      corners.push_back({cornersOf(t), cornersOf(u)});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      reportItem(i, pairs.size(), 1);
      work(pairs[i], corners[i]);
    }
  }

  bool areCornersOf(const std::array<Index, 2>& pair, const Corners& corners) const {
    return cornersOf(pair[0]) == corners[0] && cornersOf(pair[1]) == corners[1];
  }

  static std::vector<Index> seedsOf(const Corners& corners) {
    std::vector<Index> seeds(corners[0].begin(), corners[0].end());
    seeds.insert(seeds.end(), corners[1].begin(), corners[1].end());
    return seeds;
  }

  /// Ruins and recreates a part, and flips apart what intersects then: commits that if fewer
  /// triangles around it intersect, or as many at an energy that was lower before the flips.
  void tryByNumber(const std::vector<Index>& seeds, std::size_t size, Tally& tally) {
    if (!mayRepair())
      return;
    optimizer_.watch(optimizer_.spread(seeds, 2 * size + tuned::kWatchedVertices, random_));
    tryPart(
        seeds, size,
        [&](double change) {
          const int more = optimizer_.flipChangedApart();
          return more < 0 || (more == 0 && MeshOptimizer::isGain(change));
        },
        tally);
  }

  void analyze() {
    const internal::Sampling sampling = internal::analyzeSampling(*points_, graph_, threads_);
    result_.report.alignment = sampling.alignment;
    result_.report.unevenness = sampling.unevenness;
  }

  bool isEven() const {
    return result_.report.alignment < tuned::kMaxUnalignedSampling &&
           result_.report.unevenness < tuned::kMaxEvenSampling;
  }

  /// The energy that suits the cloud's sampling.
  ///
  /// \param mu where it is not even.
  void setFlipEnergy(double mu) {
    if (!isEven()) {
      // The angle itself would cut the corners of coarse round rims for good.
      optimizer_.setEnergy(energyOf(Bend::Power, mu));
      return;
    }
    optimizer_.setExcessEnergy(tuned::kEvenPolishMu, tuned::kTypicalAngleFactor,
                               tuned::kMinTypicalAngle);
  }

  /// Returns whether there was time for it.
  bool polish() {
    if (isOutOfTime())
      return false;
    setFlipEnergy(tuned::kPolishMu);
    flips("polish");
    if (!isEven())
      relocate(optimizer_.roughVertices(tuned::kMinSmoothCosine));
    return true;
  }

  /// Goes back to the mesh before the polish if fewer of its triangles intersect.
  void rollBackPolish(const Triangles& unpolished) {
    OptimizationPhase& rolled_back = phase("roll back", [&] {
      const Triangles polished = optimizer_.mesh().triangles();
      optimizer_.reset(unpolished);
      auto pairs = optimizer_.intersections(report_);
      if (pairs.size() < result_.self_intersections.size()) {
        result_.self_intersections = std::move(pairs);
        return Tally{1, 1};
      }
      optimizer_.reset(polished);
      return Tally{1, 0};
    });
    rolled_back.self_intersections = result_.self_intersections.size();
  }

  const Graph& graph_;
  const OptimizationOptions& options_;
  int threads_;
  internal::FractionReport report_;
  const Positions* given_;
  const Positions* points_;  ///< given, or smoothed_
  Positions smoothed_;
  std::uint64_t random_;
  std::optional<Clock::time_point> deadline_;
  std::size_t max_work_;  ///< \see MeshOptimizer::work
  std::optional<internal::OpenPlaces> openings_;
  MeshOptimizer optimizer_;
  MeshOptimization result_;
};

}  // namespace

MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options,
                              std::uint32_t seed, const Execution& execution) {
  return internal::optimizeMesh(points, triangles, graph, nullptr, options, seed, execution);
}

MeshOptimization internal::optimizeMesh(const Positions& points, const Triangles& triangles,
                                        const Graph& graph, const OpenPlaces* openings,
                                        const OptimizationOptions& options, std::uint32_t seed,
                                        const Execution& execution) {
  return Optimization(points, triangles, graph, openings, options, seed, execution).run();
}

}  // namespace spherical_param
