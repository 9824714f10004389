#include "spherical_param/sphere_embedding.h"

#include "embedding_energy.h"
#include "embedding_newton.h"
#include "graph_checks.h"
#include "multigrid.h"
#include "option_checks.h"
#include "parallel.h"
#include "planar_start.h"
#include "progress.h"
#include "tangential_laplacian.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::EmbeddingEnergy;
using internal::MultigridPreconditioner;
using internal::NewtonReport;
using internal::PaddedPositions;
using internal::Rows;
using internal::ShareReport;
using internal::WeightRule;

/// Relative residual to which a level is solved fully: limbs shrink exponentially along the sphere,
/// so that no absolute tolerance would tell whether their tips are solved.
constexpr double kSolvedTolerance = 1e-4;
/// Linear systems of so many nodes are solved directly.
constexpr std::size_t kDirectSize = 2000;
/// Smoothing sweeps on a planar start, whose edges are far from their lengths.
constexpr int kStartSweeps = 3;
/// An embedding with a longer mean of its directions has collapsed.
constexpr double kCollapsedCentroid = 0.95;
/// Beyond this mean it collapses further, by the same factor in each step, unless there is a
/// barrier.
constexpr double kHopelessCentroid = 0.99;
/// Finer levels than the coarsest are tried up to this size, where all starts collapse: the fewer
/// nodes are around a limb, the weaker is the barrier that keeps the sphere from slipping off it.
constexpr std::size_t kLargestStart = 100000;
/// A start is solved in about as much work as so many passes over the nodes.
constexpr int kPassesOfStart = 200;
/// Beyond this mean the embedding has slipped along a tube towards one of its ends.
constexpr double kSlippedCentroid = 0.5;
/// Passes over the nodes of a level that its other work takes about as long as, for the progress:
/// before the sweeps (some of them to interpolate), for the residual thereafter, and to solve the
/// finest level.
constexpr double kPassesOfInterpolation = 1.5;
constexpr double kPassesBefore = 4.0;
constexpr double kPassesOfResidual = 3.0;
constexpr double kPassesOfSolution = 60.0;

void checkInput(const Graph& graph, const GraphHierarchy& hierarchy,
                const MultilevelOptions& options) {
  const auto fail = [](const std::string& what) { throw InvalidInput("embedMultilevel: " + what); };
  internal::checkGraph("embedMultilevel", graph);
  std::size_t finer = graph.size();
  for (const HierarchyLevel& level : hierarchy.levels) {
    internal::checkGraph("embedMultilevel", level.graph);
    const auto are_below = [](const std::vector<Index>& indices, std::size_t end) {
      return std::all_of(indices.begin(), indices.end(),
                         [&](Index i) { return i >= 0 && static_cast<std::size_t>(i) < end; });
    };
    if (level.aggregate_of.size() != finer || level.seeds.size() != level.graph.size() ||
        !are_below(level.aggregate_of, level.graph.size()) || !are_below(level.seeds, finer) ||
        static_cast<std::size_t>(level.prolongation.rows()) != finer ||
        static_cast<std::size_t>(level.prolongation.cols()) != level.graph.size())
      fail("the hierarchy is not that of the graph; use buildGraphHierarchy() on it");
    finer = level.graph.size();
  }
  internal::checkEnum("embedMultilevel: weights", options.weights, EdgeWeights::Adaptive);
  if (!(options.exponent > 2.0 && options.exponent <= 16.0))
    fail("exponent = " + std::to_string(options.exponent) + " is out of range; use (2, 16]");
  if (!(options.lambda > 0.0 && options.lambda <= 1.0))
    fail("lambda = " + std::to_string(options.lambda) + " is out of range; use (0, 1]");
  if (options.sweeps < 0)
    fail("sweeps = " + std::to_string(options.sweeps) + "; use 0 or more");
  if (options.solved_size < 0)
    fail("solved_size = " + std::to_string(options.solved_size) + "; use 0 or more");
  if (options.tolerance && !(*options.tolerance >= 0.0))
    fail("tolerance = " + std::to_string(*options.tolerance) + "; use 0 or more");
  constexpr int most_starts = 100;
  if (options.starts < 1 || options.starts > most_starts)
    fail("starts = " + std::to_string(options.starts) + " is out of range; use 1 to 100");
  if (options.threads < 0 || options.threads > internal::kMostThreads)
    fail("threads = " + std::to_string(options.threads) + " is out of range; use 0 (all) to " +
         std::to_string(internal::kMostThreads));
}

/// The work on all levels; level 0 is the graph itself.
class Solver {
public:
  Solver(const Graph& graph, const GraphHierarchy& hierarchy, const MultilevelOptions& options)
      : graph_(graph), hierarchy_(hierarchy), options_(options) {}

  MultilevelEmbedding run() {
    result_.levels.resize(hierarchy_.levels.size() + 1);
    for (std::size_t l = 0; l < result_.levels.size(); ++l) {
      result_.levels[l].nodes = graphOf(l).size();
      result_.levels[l].edges = graphOf(l).edgeCount();
    }
    planProgress();
    std::size_t level = 0;
    Positions u = solveCoarsest(level);
    if (u.cols() == 0) {
      result_.stop_reason = StopReason::Collapsed;
      return std::move(result_);
    }
    for (std::size_t l = level; l-- > 0;) {
      u = interpolated(l, u);
      observe(l, EmbeddingStep::Start, 0, std::nullopt, u);
      const double before = share_before_[l];
      const double passes = kPassesBefore + options_.sweeps + kPassesOfResidual;
      report(before + (share_after_[l] - before) * kPassesOfInterpolation / passes, residual_);
      smooth(
          l, options_.weights, options_.sweeps,
          [&](double sweeps) {
            report(before + (share_after_[l] - before) * (kPassesBefore + sweeps) / passes,
                   residual_);
          },
          u);
      result_.levels[l].sweeps = options_.sweeps;
      const bool is_last = l == 0;  // finish() has the rest
      const bool solves = isSolved(l) && !(is_last && options_.tolerance);
      if (solves || is_last)
        observe(l, EmbeddingStep::Sweeps, options_.sweeps, std::nullopt, u);
      if (solves)
        solveUncollapsed(l, std::nullopt, u);
      if (is_last)
        break;
      result_.levels[l].residual = residualOf(l, u);
      if (!solves)
        observe(l, EmbeddingStep::Sweeps, options_.sweeps, result_.levels[l].residual, u);
      report(share_after_[l], result_.levels[l].residual);
    }
    finish(u);
    return std::move(result_);
  }

private:
  const Graph& graphOf(std::size_t l) const {
    return l == 0 ? graph_ : hierarchy_.levels[l - 1].graph;
  }

  bool isSolved(std::size_t l) const {
    return graphOf(l).size() <= static_cast<std::size_t>(options_.solved_size);
  }

  bool isAdaptive() const { return options_.weights == EdgeWeights::Adaptive; }

  EmbeddingEnergy adaptiveEnergy(std::size_t l) const {
    return {graphOf(l), false, options_.exponent, options_.threads};
  }

  EmbeddingEnergy energyWithout(std::size_t l) const {
    const bool uniform = options_.weights == EdgeWeights::Uniform;
    return isAdaptive() ? adaptiveEnergy(l)
                        : EmbeddingEnergy(graphOf(l), uniform, 2.0, options_.threads);
  }

  /// The energy of the chosen weights, with a barrier for weights that have none of their own, and
  /// for graphs on which that of adaptive weights does not hold.
  EmbeddingEnergy energyAt(std::size_t l, const Positions& u) const {
    EmbeddingEnergy energy = energyWithout(l);
    if (!isAdaptive() || result_.added_barrier)
      energy.addBarrier(u);
    return energy;
  }

  /// Mean length of the tangential Laplacian on a level.
  double residualOf(std::size_t l, const Positions& u) const {
    Positions gradient;
    return energyWithout(l).gradient(u, gradient).absolute;
  }

  /// Estimates the share of each level, by the passes over its nodes.
  void planProgress() {
    const std::size_t coarsest = hierarchy_.levels.size();
    const auto passes = [&](std::size_t l, double count) {
      return count * static_cast<double>(graphOf(l).size());
    };
    std::vector<double> work(coarsest + 1);
    work[coarsest] = passes(coarsest, kPassesOfStart * options_.starts);
    for (std::size_t l = 0; l < coarsest; ++l)
      work[l] = passes(l, kPassesBefore + options_.sweeps + kPassesOfResidual +
                              (isSolved(l) ? kPassesOfStart : 0.0));
    const double all = std::accumulate(work.begin(), work.end(), 0.0) +
                       (options_.tolerance ? passes(0, kPassesOfSolution) : 0.0);
    share_before_.resize(work.size());
    share_after_.resize(work.size());
    double share = 0.0;
    for (std::size_t l = work.size(); l-- > 0;) {
      share_before_[l] = share;
      share = std::min(1.0, share + work[l] / all);
      share_after_[l] = share;
    }
  }

  /// Tells the callback; the share never falls.
  void report(double share, double residual) {
    share_ = std::max(share_, share);
    residual_ = residual;
    if (options_.progress && !options_.progress(share_, residual))
      throw Cancelled("embedMultilevel: cancelled by the progress callback");
  }

  void observe(std::size_t l, EmbeddingStep step, int iteration, std::optional<double> residual,
               const Positions& u) const {
    if (options_.observer)
      options_.observer({l, graphOf(l).size(), step, iteration, residual, [&u] { return u; }});
  }

  /// Shows the start that was kept on its way. Several threads had several of them at the same
  /// time: only now is it known which one to look at, and its states were not kept.
  void showStart(std::size_t l) {
    if (!options_.observer)
      return;
    observe(l, EmbeddingStep::Start, 0, std::nullopt,
            internal::planarStart(graphOf(l), best_center_));
    Start start;
    MultigridPreconditioner preconditioner = preconditionerOf(l);
    const auto progress = [&](int iteration, double residual) {
      report(share_, residual);
      observe(l, EmbeddingStep::Newton, iteration, residual, start.u);
    };
    solveStart(l, best_center_, preconditioner, progress, start);
  }

  /// The start on the coarsest level that has a good one, or else the last one found. If none
  /// is, as on graphs of a few nodes or with wide gaps, that on the coarsest level with a barrier.
  Positions solveCoarsest(std::size_t& level) {
    Positions best;
    level = hierarchy_.levels.size();
    for (std::size_t l = level + 1; l-- > 0;) {
      if (l < hierarchy_.levels.size() && graphOf(l).size() > kLargestStart)
        break;
      Positions u = solveStarts(l);
      if (u.cols() == 0)
        continue;
      best = std::move(u);
      level = l;
      // With too few nodes around a limb it may have slipped along it: try more.
      if (best.rowwise().mean().norm() < kSlippedCentroid)
        break;
    }
    if (best.cols() == 0) {
      result_.added_barrier = true;
      level = hierarchy_.levels.size();
      best = solveStarts(level);
    }
    if (best.cols() > 0)
      showStart(level);
    if (best.cols() > 0 && !isAdaptive())
      solve(level, energyAt(level, best), std::nullopt, best);
    return best;
  }

  static bool isCollapsed(const Positions& u) {
    return !(u.rowwise().mean().norm() <= kCollapsedCentroid);
  }

  /// One start of a level and what came of it.
  struct Start {
    Positions u;
    LevelReport report;
    double value = 0.0;
    std::exception_ptr error;
  };

  /// Unfolds a start and solves it, with adaptive weights, whatever was chosen: only they do not
  /// collapse it. Several threads may do so at once.
  void solveStart(std::size_t l, Index center, MultigridPreconditioner& preconditioner,
                  const std::function<void(int, double)>& progress, Start& start) const {
    start.u = internal::planarStart(graphOf(l), center);
    start.report.sweeps = kStartSweeps;
    EmbeddingEnergy energy = adaptiveEnergy(l);
    if (result_.added_barrier)
      energy.addBarrier(start.u);
    smooth(l, EdgeWeights::Adaptive, kStartSweeps, {}, start.u);
    minimize(energy, std::nullopt, preconditioner, progress, start.u, start.report);
    start.value = energy.value(start.u);
  }

  /// The best of several starts on a level, solved fully; without columns if all collapse. Each
  /// thread has starts of its own: only the calling one tells of its progress.
  Positions solveStarts(std::size_t l) {
    const std::vector<Index> centers = internal::centralNodes(graphOf(l));
    const std::size_t count = std::min(centers.size(), static_cast<std::size_t>(options_.starts));
    const auto most = static_cast<std::size_t>(
        internal::threadCount(options_.threads, std::size_t{kPassesOfStart} * graphOf(l).size(),
                              internal::kShortPassThreshold));
    const std::size_t threads = std::min(most, count);
    std::vector<MultigridPreconditioner> preconditioners(threads, preconditionerOf(l));
    LevelReport best_report;
    Positions best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t first = 0; first < count; first += threads) {
      std::vector<Start> starts(std::min(threads, count - first));
      for (Start& start : starts)
        start.report = result_.levels[l];
      report(share_after_.back() * static_cast<double>(first) / options_.starts, 0.0);
      std::atomic<bool> has_failed{false};
      internal::forEachTask(
          starts.size(), static_cast<int>(threads), [&](std::size_t thread, std::size_t i) {
            const auto progress = [&](int, double residual) {
              if (thread == 0)
                report(share_, residual);
              else if (has_failed.load(std::memory_order_relaxed))
                throw Cancelled("embedMultilevel: another start failed");
            };
            try {
              solveStart(l, centers[first + i], preconditioners[thread], progress, starts[i]);
            } catch (...) {
              starts[i].error = std::current_exception();
              has_failed.store(true, std::memory_order_relaxed);
            }
          });
      // That of the calling thread comes first.
      for (const Start& start : starts)
        if (start.error)
          std::rethrow_exception(start.error);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        Start& start = starts[i];
        ++result_.starts;
        if (isCollapsed(start.u) || !std::isfinite(start.value)) {
          ++result_.collapsed_starts;
        } else if (start.value < least) {
          least = start.value;
          best = std::move(start.u);
          best_report = start.report;
          best_center_ = centers[first + i];
        }
      }
    }
    if (best.cols() > 0)
      result_.levels[l] = best_report;
    return best;
  }

  /// Unit vectors on a level between those of the next coarser one.
  Positions interpolated(std::size_t l, const Positions& coarse) const {
    const auto& weights = hierarchy_.levels[l].prolongation;
    const auto n = static_cast<std::size_t>(weights.rows());
    Positions u(3, weights.rows());
    internal::forEachBlock(
        n, internal::threadCount(options_.threads, n, internal::kShortPassThreshold),
        [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (Index e = weights.outerIndexPtr()[i]; e < weights.outerIndexPtr()[i + 1]; ++e)
              sum += weights.valuePtr()[e] * coarse.col(weights.innerIndexPtr()[e]);
            u.col(static_cast<Eigen::Index>(i)) = sum.normalized();
          }
        });
    return u;
  }

  /// Damped Jacobi sweeps: lambda times the tangential Laplacian, all nodes at once.
  ///
  /// \param swept told the number of sweeps before the first one, and after each; may be empty.
  void smooth(std::size_t l, EdgeWeights weights, int sweeps, const ShareReport& swept,
              Positions& u) const {
    const Graph& graph = graphOf(l);
    Rows rows = internal::makeRows(
        graph, weights == EdgeWeights::Uniform,
        internal::threadCount(options_.threads, graph.size(), internal::kShortPassThreshold));
    rows.power = options_.exponent - 2.0;
    PaddedPositions current(4, u.cols());
    current.topRows<3>() = u;
    current.row(3).setZero();
    PaddedPositions next(4, u.cols());
    next.row(3).setZero();
    internal::tell(swept, 0.0);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      if (weights != EdgeWeights::Adaptive)
        sweepOnce<WeightRule::Fixed>(rows, current, next);
      else if (options_.exponent == 3.0)
        sweepOnce<WeightRule::Linear>(rows, current, next);
      else
        sweepOnce<WeightRule::Power>(rows, current, next);
      std::swap(current, next);
      internal::tell(swept, sweep + 1.0);
    }
    u = current.topRows<3>();
  }

  template <WeightRule Rule>
  void sweepOnce(const Rows& rows, const PaddedPositions& current, PaddedPositions& next) const {
    // Along an edge the energy is p - 1 times as stiff as its weight: beyond p = 3 shorter steps.
    const double lambda = Rule == WeightRule::Power
                              ? options_.lambda * std::min(1.0, 2.0 / (options_.exponent - 1.0))
                              : options_.lambda;
    const auto n = static_cast<std::size_t>(rows.size());
    internal::forEachBlock(
        n, internal::threadCount(options_.threads, n, internal::kShortPassThreshold),
        [&](std::size_t, std::size_t begin, std::size_t end) {
          for (auto row = static_cast<Index>(begin); row < static_cast<Index>(end); ++row)
            next.col(row).head<3>() =
                (current.col(row).head<3>() +
                 lambda * internal::tangentialLaplacian<Rule>(rows, current, row))
                    .normalized();
        });
  }

  /// Small systems are solved directly: no slower, and exact at all scales.
  MultigridPreconditioner preconditionerOf(std::size_t l) const {
    const bool direct = graphOf(l).size() <= kDirectSize;
    return {hierarchy_, direct ? hierarchy_.levels.size() : l, options_.threads};
  }

  /// Newton's method on a level, until it is solved fully and to the tolerance, if there is one.
  static NewtonReport minimize(const EmbeddingEnergy& energy, std::optional<double> tolerance,
                               MultigridPreconditioner& preconditioner,
                               const std::function<void(int, double)>& progress, Positions& u,
                               LevelReport& report) {
    internal::NewtonOptions options;
    options.relative_tolerance = kSolvedTolerance;
    options.tolerance = tolerance.value_or(1.0);
    if (!energy.hasBarrier())
      options.longest_mean = kHopelessCentroid;
    options.progress = progress;
    NewtonReport newton = internal::minimizeByNewton(energy, preconditioner, options, u);
    report.newton_iterations += newton.iterations;
    report.linear_iterations += newton.linear_iterations;
    report.residual = newton.residuals.back();
    return newton;
  }

  /// minimize() with a level's own report.
  NewtonReport solve(std::size_t l, const EmbeddingEnergy& energy, std::optional<double> tolerance,
                     Positions& u) {
    const auto progress = [&, first = 0.0](int iteration, double residual) mutable {
      observe(l, EmbeddingStep::Newton, iteration, residual, u);
      if (l > 0 || !tolerance)
        return report(share_, residual);
      first = std::max(first, residual);
      // The residual falls from step to step by more and more orders of magnitude.
      const double goal = std::max(*options_.tolerance, 1e-16);
      const double done = std::log(first / residual) / std::log(std::max(first / goal, 2.0));
      const double before = share_after_[0];
      report(before + (1.0 - before) * std::clamp(done, 0.0, 1.0), residual);
    };
    MultigridPreconditioner preconditioner = preconditionerOf(l);
    return minimize(energy, tolerance, preconditioner, progress, u, result_.levels[l]);
  }

  /// Solves a level from an embedding that is not collapsed; adds a barrier if it becomes so.
  NewtonReport solveUncollapsed(std::size_t l, std::optional<double> tolerance, Positions& u) {
    Positions solved = u;
    NewtonReport newton = solve(l, energyAt(l, u), tolerance, solved);
    if (isCollapsed(solved) && !result_.added_barrier) {
      result_.added_barrier = true;
      solved = u;
      newton = solve(l, energyAt(l, u), tolerance, solved);
    }
    u = std::move(solved);
    return newton;
  }

  void finish(Positions& u) {
    if (options_.tolerance) {
      NewtonReport newton = solveUncollapsed(0, options_.tolerance, u);
      result_.residuals = std::move(newton.residuals);
    }
    result_.residual = residualOf(0, u);
    result_.levels[0].residual = result_.residual;
    report(share_after_[0] - (share_after_[0] - share_) / 3.0, result_.residual);
    result_.energy = energyWithout(0).value(u);
    // The Laplacian alone decides: where a barrier pulls, its solution has not converged.
    if (options_.tolerance)
      result_.stop_reason =
          result_.residual <= *options_.tolerance ? StopReason::Converged : StopReason::Stagnated;
    report(1.0, result_.residual);
    result_.centroid_norm = u.rowwise().mean().norm();
    if (isCollapsed(u))
      result_.stop_reason = StopReason::Collapsed;
    observe(0, EmbeddingStep::End, 0, result_.residual, u);
    result_.directions = std::move(u);
  }

  const Graph& graph_;
  const GraphHierarchy& hierarchy_;
  const MultilevelOptions& options_;
  MultilevelEmbedding result_;
  double share_ = 0.0;     ///< of the work that is done
  double residual_ = 0.0;  ///< told last
  Index best_center_ = 0;  ///< of the start that solveStarts() kept last
  /// Of the work that is done before and after each level, about.
  std::vector<double> share_before_;
  std::vector<double> share_after_;
};

}  // namespace

MultilevelEmbedding embedMultilevel(const Graph& graph, const GraphHierarchy& hierarchy,
                                    const MultilevelOptions& options) {
  checkInput(graph, hierarchy, options);
  if (graph.size() == 0) {
    MultilevelEmbedding nothing;
    nothing.directions.resize(3, 0);
    nothing.stop_reason = StopReason::Converged;
    return nothing;
  }
  return Solver(graph, hierarchy, options).run();
}

}  // namespace spherical_param
