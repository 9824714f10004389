#include "spherical_param/mesh_optimization.h"

#include "graph_checks.h"
#include "mesh_optimizer.h"
#include "option_checks.h"
#include "parallel.h"
#include "progress.h"
#include "sampling_analysis.h"
#include "spherical_param/errors.h"
#include "spherical_param/smoothing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

using internal::MeshOptimizer;
using internal::SurfaceEnergy;
using Bend = SurfaceEnergy::Bend;

/// mu of equation (1), and those of the polish.
constexpr double kMu = 0.3;
constexpr double kPolishMu = 0.8;
constexpr double kEvenPolishMu = 4.0;

/// Edges with a smaller cosine between their triangles' normals (37 degrees) are sharp, those with
/// the other one (120 degrees) folded.
constexpr double kSharp = 0.8;
constexpr double kFolded = -0.5;

/// Share of rough vertices above which the cloud is noisy. Clouds of closed surfaces without noise
/// have 0.003 to 0.16, and coarse ones with limbs of a few points 0.36; with noise of a quarter of
/// the points' distance it is 0.75 and more.
constexpr double kNoisy = 0.5;
/// Steps of smoothing that are tried in turn, until no more than this share is rough.
constexpr std::array<int, 4> kSmoothingSteps{3, 6, 12, 24};
constexpr double kSmoothEnough = 0.5;
/// The sampling follows the curvature from here on. Simplified and designed models have 0.19 to
/// 0.63, scans and even or random samplings -0.01 to 0.13.
constexpr double kAligned = 0.16;
/// Below this unevenness the points are spread evenly. Scans and even samplings have 0.03 to 0.22,
/// random samplings 0.33 to 0.39.
constexpr double kUneven = 0.3;
/// Of an even sampling, angles up to so many times the median around a vertex are usual, and up to
/// the least one [rad], 10 degrees.
constexpr double kUsual = 5.0;
constexpr double kLeastUsual = 0.17453292519943295;

constexpr int kRelocateRounds = 4;
constexpr int kRecreateRounds = 5;
constexpr int kUntangleRounds = 16;
/// Rounds of untangling in which the energy alone decides: it knows the way out better than the
/// number of intersections does, but may be stuck with the last ones.
constexpr int kRoundsByEnergy = 5;
/// What a self-intersection may cost to be rid of [mean length of the graph's edges].
constexpr double kPriceOfIntersection = 10.0;
/// Untangling noisy points as they are takes long, and is in vain, above this number of
/// intersections for each triangle; so few in all are tried anyway.
constexpr double kFewIntersections = 0.005;
constexpr double kFewInAll = 1500.0;

/// Vertices that may be taken out in parts, in all.
std::size_t budgetOf(std::size_t points) {
  constexpr std::size_t of_point = 5;
  constexpr std::size_t extra = 50000;
  constexpr std::size_t of_point_at_most = 200;  // small clouds should not take long either
  return std::min(extra + of_point * points, of_point_at_most * points);
}

SurfaceEnergy energyOf(Bend bend, double mu) {
  SurfaceEnergy energy;
  energy.bend = bend;
  energy.mu = mu;
  return energy;
}

void checkInput(const Positions& points, const Triangles& triangles, const Graph& graph) {
  const auto n = static_cast<std::size_t>(points.cols());
  internal::checkGraph("optimizeMesh", graph);
  if (graph.size() != n)
    throw InvalidInput("optimizeMesh: " + std::to_string(n) + " points, but a graph of " +
                       std::to_string(graph.size()) + " nodes; they must be the same");
  if (!points.allFinite())
    throw InvalidInput("optimizeMesh: a coordinate is not finite; leave such points out");
  if (triangles.size() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= points.cols()))
    throw InvalidInput("optimizeMesh: a triangle names a vertex that is none of the " +
                       std::to_string(n) + " points; indices start at 0");
}

/// The optimiser of a mesh that is as it should be.
MeshOptimizer checkedOptimizer(const Positions& points, const Triangles& triangles,
                               const Graph& graph, int threads, const internal::Report& report) {
  checkInput(points, triangles, graph);
  internal::tell(report, 0.0);
  MeshOptimizer optimizer(points, triangles, graph, threads, report);
  if (!optimizer.mesh().isSphere(threads))
    throw InvalidInput("optimizeMesh: the triangles must be a closed, manifold, consistently "
                       "oriented mesh of genus 0 over all points");
  return optimizer;
}

class Optimization {
public:
  Optimization(const Positions& points, const Triangles& triangles, const Graph& graph,
               const OptimizationOptions& options, std::uint32_t seed, const Execution& execution)
      : graph_(graph), options_(options), threads_(execution.threads),
        report_(internal::reportOf(execution, "optimization")), given_(&points), points_(&points),
        random_(seed), budget_(budgetOf(static_cast<std::size_t>(points.cols()))),
        optimizer_(checkedOptimizer(points, triangles, graph, threads_, report_)) {}

  MeshOptimization run() {
    switch (options_.method) {
    case OptimizationMethod::None:
      optimizer_.setEnergy(energyOf(Bend::Angle, kMu));
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
  /// What a phase tried, and what of it stayed.
  struct Tally {
    std::size_t tried = 0;
    std::size_t moves = 0;
  };

  template <typename Work>
  OptimizationPhase& phase(const char* name, const Work& work) {
    OptimizationPhase phase;
    phase.name = name;
    phase.energy_before = optimizer_.energy();
    const auto begin = std::chrono::steady_clock::now();
    const Tally tally = work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    phase.tried = tally.tried;
    phase.moves = tally.moves;
    phase.energy = optimizer_.energy();
    phase.seconds = time.count();
    result_.report.phases.push_back(phase);
    return result_.report.phases.back();
  }

  void flips(const char* name) {
    phase(name, [&] { return Tally{0, optimizer_.flipAll(report_)}; });
  }

  void flipFirst() {
    analyze();
    setFlipEnergy(kMu);
    flips("flips");
    optimizer_.setEnergy(energyOf(Bend::Angle, kMu));
  }

  void runFull() {
    std::vector<Index> rough = optimizer_.roughVertices(kSharp, report_);
    result_.report.rough =
        static_cast<double>(rough.size()) / static_cast<double>(points_->cols());
    if (result_.report.rough > kNoisy)
      rough = beginOnNoise();
    relocate(rough);
    // Where nothing is folded, hardly anything intersects: once after the polish is enough.
    if (recreate())
      untangle();
    const Triangles unpolished = optimizer_.mesh().triangles();
    polish();
    // With the first energy: it is what keeps sheets apart.
    optimizer_.setEnergy(energyOf(Bend::Angle, kMu));
    result_.self_intersections = untangle();
    if (!result_.self_intersections.empty())
      rollBackPolish(unpolished);
    if (result_.report.noise_steps > 0)
      endOnNoise();
  }

  /// Goes on with less noisy positions. Returns the rough vertices.
  std::vector<Index> beginOnNoise() {
    std::vector<Index> rough;
    for (const int steps : kSmoothingSteps) {
      const SmoothingOptions smoothing{SmoothingMethod::Umbrella, steps, false};
      smoothed_ =
          smoothSurface(*given_, optimizer_.mesh().triangles(), smoothing, threads_).points;
      result_.report.noise_steps = steps;
      points_ = &smoothed_;
      optimizer_.setPoints(smoothed_);
      analyze();
      flips("flips");
      rough = optimizer_.roughVertices(kSharp, report_);
      if (static_cast<double>(rough.size()) <= kSmoothEnough * static_cast<double>(points_->cols()))
        break;
    }
    return rough;
  }

  /// Once more on the points as they are, where only few triangles intersect.
  void endOnNoise() {
    points_ = given_;
    optimizer_.setPoints(*points_);
    if (!options_.finish_on_points)
      return;
    result_.report.smoothed_self_intersections = result_.self_intersections.size();
    result_.self_intersections =
        optimizer_.intersections(report_);
    const auto count = static_cast<double>(result_.self_intersections.size());
    if (count <= std::max(kFewInAll, kFewIntersections * optimizer_.mesh().size()))
      result_.self_intersections = untangle();
  }

  /// Reports which of the items of a round is next.
  void tellItem(std::size_t item, std::size_t items, std::size_t between_reports) {
    if (item % between_reports == 0)
      internal::tell(report_, static_cast<double>(item) / static_cast<double>(items));
  }

  void relocate(std::vector<Index> rough) {
    for (int round = 0; round < kRelocateRounds && !rough.empty(); ++round) {
      std::vector<Index> moved;
      phase("relocate", [&] {
        for (std::size_t i = 0; i < rough.size(); ++i) {
          tellItem(i, rough.size(), 256);
          if (optimizer_.relocate(rough[i]))
            moved.push_back(rough[i]);
        }
        return Tally{rough.size(), moved.size()};
      });
      if (moved.empty())
        break;
      // Elsewhere all is as before.
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
      rough.erase(std::remove_if(rough.begin(), rough.end(),
                                 [&](Index v) { return !optimizer_.isRough(v, kSharp); }),
                  rough.end());
    }
  }

  /// Returns whether folded edges are left.
  bool recreate() {
    for (int round = 0; round < kRecreateRounds; ++round) {
      const auto folded = optimizer_.edgesBelow(kFolded);
      if (folded.empty() || budget_ == 0)
        return !folded.empty();
      phase("ruin and recreate", [&] {
        Tally tally;
        for (std::size_t i = 0; i < folded.size(); ++i) {
          tellItem(i, folded.size(), 16);
          const auto& [v, w] = folded[i];
          for (std::size_t size = 4; size <= 32; size *= 2)
            if (optimizer_.mesh().areJoined(v, w))
              tryPart({v, w}, size, MeshOptimizer::isGain, tally);
        }
        return tally;
      });
    }
    return !optimizer_.edgesBelow(kFolded).empty();
  }

  /// Takes out and puts back a part around some vertices, while the budget lasts.
  void tryPart(const std::vector<Index>& seeds, std::size_t size,
               const std::function<bool(double)>& accept, Tally& tally) {
    if (budget_ == 0)
      return;
    const std::vector<Index> part = optimizer_.spread(seeds, size, random_);
    budget_ -= std::min(budget_, part.size());
    ++tally.tried;
    tally.moves += optimizer_.recreate(part, accept, random_) ? 1 : 0;
  }

  /// The three vertices of a triangle.
  std::array<Index, 3> cornersOf(Index t) const {
    return {optimizer_.mesh().vertex(t, 0), optimizer_.mesh().vertex(t, 1),
            optimizer_.mesh().vertex(t, 2)};
  }

  /// Ends with the mesh of fewest intersections on the way, and returns these.
  std::vector<std::array<Index, 2>> untangle() {
    auto pairs = optimizer_.intersections(report_);
    result_.report.phases.back().self_intersections = pairs.size();
    auto fewest = pairs;
    Triangles best;
    for (int round = 0; round < kUntangleRounds && !pairs.empty() && budget_ > 0; ++round) {
      if (pairs.size() <= fewest.size()) {
        best = optimizer_.mesh().triangles();
        fewest = pairs;
      }
      OptimizationPhase& untangled = phase("untangle", [&] {
        Tally tally;
        std::vector<std::array<std::array<Index, 3>, 2>> corners;
        corners.reserve(pairs.size());
        for (const auto& [t, u] : pairs)
          corners.push_back({cornersOf(t), cornersOf(u)});
        for (std::size_t i = 0; i < pairs.size(); ++i) {
          tellItem(i, pairs.size(), 16);
          untanglePair(pairs[i], corners[i], round >= kRoundsByEnergy, tally);
        }
        return tally;
      });
      pairs = optimizer_.intersections(report_);
      untangled.self_intersections = pairs.size();
    }
    if (pairs.size() <= fewest.size())
      return pairs;
    optimizer_.reset(best);
    result_.report.phases.back().energy = optimizer_.energy();
    result_.report.phases.back().self_intersections = fewest.size();
    return fewest;
  }

  void untanglePair(const std::array<Index, 2>& pair,
                    const std::array<std::array<Index, 3>, 2>& corners, bool by_number,
                    Tally& tally) {
    std::vector<Index> seeds(corners[0].begin(), corners[0].end());
    seeds.insert(seeds.end(), corners[1].begin(), corners[1].end());
    for (std::size_t size = 6; size <= 96; size *= 2) {
      // Whatever changed here is looked at in the next round.
      if (cornersOf(pair[0]) != corners[0] || cornersOf(pair[1]) != corners[1])
        return;
      if (!by_number) {
        tryPart(seeds, size, MeshOptimizer::isGain, tally);
        continue;
      }
      const std::vector<Index> around = optimizer_.spread(seeds, 2 * size + 200, random_);
      const auto before = static_cast<double>(optimizer_.intersectionsAround(around));
      tryPart(
          seeds, size,
          [&](double change) {
            const auto after = static_cast<double>(optimizer_.intersectionsAround(around));
            return after < before ? change < kPriceOfIntersection * (before - after)
                                  : after == before && MeshOptimizer::isGain(change);
          },
          tally);
    }
  }

  void analyze() {
    const internal::Sampling sampling =
        internal::analyzeSampling(*points_, graph_, threads_);
    result_.report.alignment = sampling.alignment;
    result_.report.unevenness = sampling.unevenness;
  }

  bool isEven() const { return result_.report.alignment < kAligned && result_.report.unevenness < kUneven; }

  /// The energy that suits the cloud's sampling.
  ///
  /// \param mu where it is not even.
  void setFlipEnergy(double mu) {
    if (!isEven()) {
      // Not by the angle itself: that cuts the corners of coarse round rims, and never finds back.
      optimizer_.setEnergy(energyOf(Bend::Power, mu));
      return;
    }
    optimizer_.setExcessEnergy(kEvenPolishMu, kUsual, kLeastUsual);
  }

  void polish() {
    setFlipEnergy(kPolishMu);
    flips("polish");
    if (!isEven())
      relocate(optimizer_.roughVertices(kSharp));
  }

  /// Goes back to the mesh before the polish if fewer of its triangles intersect.
  void rollBackPolish(const Triangles& unpolished) {
    phase("roll back", [&] {
      const Triangles polished = optimizer_.mesh().triangles();
      optimizer_.reset(unpolished);
      auto pairs = optimizer_.intersections(report_);
      if (pairs.size() < result_.self_intersections.size()) {
        result_.self_intersections = std::move(pairs);
        return Tally{1, 1};
      }
      optimizer_.reset(polished);
      return Tally{1, 0};
    }).self_intersections = result_.self_intersections.size();
  }

  const Graph& graph_;
  const OptimizationOptions& options_;
  int threads_;
  internal::Report report_;
  const Positions* given_;
  const Positions* points_;  ///< given, or smoothed_
  Positions smoothed_;
  std::uint64_t random_;
  std::size_t budget_;  ///< vertices that may still be taken out in parts
  MeshOptimizer optimizer_;
  MeshOptimization result_;
};

}  // namespace

MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options,
                              std::uint32_t seed, const Execution& execution) {
  internal::checkOptions(options);
  return Optimization(points, triangles, graph, options, seed, execution).run();
}

}  // namespace spherical_param
