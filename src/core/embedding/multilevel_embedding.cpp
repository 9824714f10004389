#include "multilevel_embedding.h"

#include "collapse.h"
#include "embedding_energy.h"
#include "embedding_newton.h"
#include "multigrid.h"
#include "parallel.h"
#include "planar_start.h"
#include "progress.h"
#include "tangential_laplacian.h"

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

namespace spherical_param::internal {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, each with the default
// options and with nearest neighbours: 8 of these 52 meshes intersect themselves. With uniform
// weights and with a tolerance there are 104 meshes, of which 13 intersect themselves.

/// Smoothing sweeps on each level. With 0 or 3, 15 of the 104 intersect themselves, with 20, 14.
constexpr int kSweeps = 10;
/// Levels of at most this number of nodes are solved, not only smoothed. With none, 20 of the
/// 104 intersect themselves, with those up to 3,000, 16, with all, 13.
constexpr std::size_t kMaxSolvedSize = 10000;
/// Relative residuals to which a start, a level and the graph itself are solved: limbs shrink
/// exponentially along the sphere, so that no absolute tolerance would show whether their tips are
/// solved. 16 clouds with 6 seeds have 19,898 intersections after the first flips if all is solved
/// to 1e-4, in 1.4 times as long, and 18,988 with these. With 1e-2 for the starts the wrong one is
/// taken of a body with limbs; with 1e-2 for the levels an armadillo has 330 instead of 79. A graph
/// that is freed of the barrier of its levels has a way to go: with 1e-3 the springer's optimised
/// energy ends above 480, instead of at 460, with 14 of 60 seeds, with 3e-4 with 9, with 1e-4 with
/// 9, and with starts on the graph itself, in 2.7 times as long, with 6.
constexpr double kStartTolerance = 3e-3;
constexpr double kLevelTolerance = 1e-3;
constexpr double kGraphTolerance = 1e-2;
constexpr double kFreedTolerance = 3e-4;
/// Linear systems of at most this number of nodes are solved directly. With all, the time is 1.5
/// times as long.
constexpr std::size_t kMaxDirectSize = 2000;
/// Smoothing sweeps on a planar start, whose edges are far from their lengths. With 0, 9 of the 52
/// intersect themselves.
constexpr int kStartSweeps = 3;
/// Beyond this mean it collapses further, by the same factor in each step, unless there is a
/// barrier. With 0.99 the meshes are the same, but take longer; with 0.9 starts are given up that
/// would not collapse.
constexpr double kMaxStartCentroid = 0.95;
/// Finer levels than the coarsest are tried up to this size, where all starts collapse and a
/// barrier pulls hard: the fewer nodes are around a limb, the weaker is the barrier that keeps the
/// sphere from slipping off it. With the coarsest alone, 441,107 pairs of triangles of a tube
/// between two balls intersect instead of 1,734; the bound limits the time.
constexpr std::size_t kMaxStartSize = 100000;
/// The sphere drifts off a wide gap without folding what is left, and a barrier that only stops
/// this drift leaves at most this relative residual without it: 0.003 to 0.056 on most bodies that
/// are cut, thinned or have holes. Where the sphere has slipped off a limb, the barrier holds the
/// folded rest, by 0.068 or more on tubes between two balls: without a bound, these and 9 other
/// shapes have 6,904,781 self-intersections after the first flips instead of 206,919. With 0, the
/// springer takes 210 ms instead of 60, half of an armadillo 4.7 s instead of 0.25.
constexpr double kMaxPull = 0.06;
/// As often other starts are tried until a barrier hardly pulls at one. With 1, an elephant from
/// eight depth images folds with one seed of nine.
constexpr int kBarrierRounds = 4;
/// A start is solved in about as much work as this number of passes over the nodes.
constexpr int kMaxStartPasses = 200;

/// The share of each node of each level in the area of the surface.
std::vector<Eigen::VectorXd> areasOf(const Graph& graph, const GraphHierarchy& hierarchy) {
  std::vector<Eigen::VectorXd> areas(1, Eigen::VectorXd(static_cast<Eigen::Index>(graph.size())));
  for (std::size_t i = 0; i < graph.size(); ++i) {
    double squares = 0.0;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      squares += graph.lengths[e] * graph.lengths[e];
    const auto degree = static_cast<double>(graph.offsets[i + 1] - graph.offsets[i]);
    areas.back()[static_cast<Eigen::Index>(i)] = squares / std::max(degree, 1.0);
  }
  areas.back() /= areas.back().sum();
  for (const HierarchyLevel& level : hierarchy.levels)
    areas.emplace_back(level.prolongation.transpose() * areas.back());
  return areas;
}

/// The work on all levels; level 0 is the graph itself.
class Solver {
public:
  Solver(const Graph& graph, const GraphHierarchy& hierarchy, const EmbeddingOptions& options,
         NodeMass mass, const EmbeddingObserver& observer, const Execution& execution)
      : graph_(graph), hierarchy_(hierarchy), options_(options), observer_(observer),
        threads_(execution.threads), weights_(options.weights, options.exponent),
        adaptive_weights_(EdgeWeights::Adaptive, options.exponent),
        report_(reportOf(execution, "embedding")),
        masses_(mass == NodeMass::ByArea
                    ? areasOf(graph, hierarchy)
                    : std::vector<Eigen::VectorXd>(hierarchy.levels.size() + 1)) {}

  Embedding run() {
    levels().resize(hierarchy_.levels.size() + 1);
    for (std::size_t l = 0; l < levels().size(); ++l)
      levels()[l] = unworked(l);
    std::size_t level = 0;
    Positions u = solveCoarsest(level);
    if (u.cols() == 0) {
      result_.report.stop_reason = StopReason::Collapsed;
      return std::move(result_);
    }
    ascend(level, u);
    // The barrier of coarser levels held a folded rest.
    if (collapsed_when_freed_ && !has_tried_finer_) {
      Positions finer = solveFiner(level);
      if (finer.cols() > 0) {
        u = std::move(finer);
        for (std::size_t l = 0; l < level; ++l)
          levels()[l] = unworked(l);
        showStart(level);
        ascend(level, u);
      }
    }
    finish(u);
    return std::move(result_);
  }

private:
  /// Takes an embedding from a level to the graph itself.
  void ascend(std::size_t level, Positions& u) {
    for (std::size_t l = level; l-- > 0;) {
      u = interpolated(l, u);
      observe(l, EmbeddingStep::Start, 0, std::nullopt, u);
      smooth(l, weights_, kSweeps, report_, u);
      levels()[l].sweeps = kSweeps;
      const bool is_last = l == 0;  // finish() has the rest
      const bool solves = isSolved(l) && !(is_last && options_.tolerance);
      if (solves || is_last)
        observe(l, EmbeddingStep::Sweeps, kSweeps, std::nullopt, u);
      if (solves)
        solveUncollapsed(l, std::nullopt, u);
      if (is_last)
        break;
      levels()[l].residual = residualOf(l, u);
      if (!solves)
        observe(l, EmbeddingStep::Sweeps, kSweeps, levels()[l].residual, u);
    }
  }

  LevelReport unworked(std::size_t l) const {
    LevelReport report;
    report.nodes = graphOf(l).size();
    report.edges = graphOf(l).edgeCount();
    return report;
  }

  const Graph& graphOf(std::size_t l) const {
    return l == 0 ? graph_ : hierarchy_.levels[l - 1].graph;
  }

  bool isSolved(std::size_t l) const { return graphOf(l).size() <= kMaxSolvedSize; }

  static double toleranceOf(std::size_t l) { return l > 0 ? kLevelTolerance : kGraphTolerance; }

  std::vector<LevelReport>& levels() { return result_.report.levels; }

  /// The energy of the chosen weights, without a barrier.
  EmbeddingEnergy energyWithout(std::size_t l) const { return {graphOf(l), weights_, threads_}; }

  /// The energy of the chosen weights, with a barrier for weights that have none of their own, and
  /// for graphs on which that of adaptive weights does not hold.
  EmbeddingEnergy energyAt(std::size_t l, const Positions& u) const {
    EmbeddingEnergy energy = energyWithout(l);
    if (weights_.needsBarrier() || result_.report.added_barrier)
      energy.addBarrier(u);
    return energy;
  }

  /// Mean length of the tangential Laplacian on a level.
  double residualOf(std::size_t l, const Positions& u) const {
    Positions gradient;
    return energyWithout(l).gradient(u, gradient).absolute;
  }

  void observe(std::size_t l, EmbeddingStep step, int iteration, std::optional<double> residual,
               const Positions& u) const {
    if (observer_)
      observer_({l, graphOf(l).size(), step, iteration, residual, [&u] { return u; }});
  }

  /// Shows the start that was kept on its way. Several threads had several of them at the same
  /// time: only now is it known which one to look at, and its states were not kept.
  void showStart(std::size_t l) {
    if (!observer_)
      return;
    observe(l, EmbeddingStep::Start, 0, std::nullopt, planarStart(graphOf(l), best_center_));
    Start start;
    MultigridPreconditioner preconditioner = preconditionerOf(l);
    const auto progress = [&](int iteration, double residual) {
      reportFraction(report_, 0.0);
      observe(l, EmbeddingStep::Newton, iteration, residual, start.u);
    };
    solveStart(l, best_center_, preconditioner, progress, start);
  }

  /// The start on the coarsest level. If all collapse there, as on graphs of a few nodes or with
  /// wide gaps, that with a barrier, if it hardly pulls. If it does, the start on the coarsest of
  /// the finer levels on which one does not collapse comes first.
  Positions solveCoarsest(std::size_t& level) {
    level = hierarchy_.levels.size();
    Positions best = solveStarts(level);
    if (best.cols() == 0) {
      const LevelReport untried = levels()[level];
      result_.report.added_barrier = true;
      best = solveStarts(level, kBarrierRounds);
      if (best.cols() == 0 || has_slipped_) {
        const std::size_t coarsest = level;
        Positions finer = solveFiner(level);
        if (finer.cols() > 0) {
          levels()[coarsest] = untried;
          best = std::move(finer);
        }
      } else {
        hardly_pulls_ = level > 0;
      }
    }
    if (best.cols() > 0)
      showStart(level);
    if (best.cols() > 0 && weights_.needsBarrier())
      solve(level, energyAt(level, best), toleranceOf(level), std::nullopt, best);
    return best;
  }

  /// A start on the coarsest of the finer levels on which one does not collapse, without a barrier;
  /// without columns, level and barrier unchanged, if there is none.
  Positions solveFiner(std::size_t& level) {
    has_tried_finer_ = true;
    const bool has_barrier = std::exchange(result_.report.added_barrier, false);
    Positions finer;
    std::size_t l = level;
    while (finer.cols() == 0 && l > 0 && graphOf(l - 1).size() <= kMaxStartSize)
      finer = solveStarts(--l);
    if (finer.cols() > 0)
      level = l;
    else
      result_.report.added_barrier = has_barrier;
    return finer;
  }

  /// How hard a barrier pulls at a start that it holds: the relative residual without it.
  double pullOf(std::size_t l, const Positions& u) const {
    Positions gradient;
    return EmbeddingEnergy(graphOf(l), adaptive_weights_, threads_).gradient(u, gradient).relative;
  }

  /// One start of a level and what came of it.
  struct Start {
    Positions u;
    LevelReport report;
    bool has_slipped = false;  ///< a barrier holds it, and pulls hard
    /// The less, the better: the energy, or how hard the barrier pulls at one that has slipped, for
    /// the energy of a folded rest is low.
    double value = 0.0;
    std::exception_ptr error;
  };

  /// Ends a start whose result is not needed any more.
  struct AnotherFailed {};

  /// Unfolds a start and solves it, with adaptive weights, whatever was chosen: only they do not
  /// collapse it. Several threads may do so at once.
  void solveStart(std::size_t l, Index center, MultigridPreconditioner& preconditioner,
                  const std::function<void(int, double)>& progress, Start& start) const {
    start.u = planarStart(graphOf(l), center);
    start.report.sweeps = kStartSweeps;
    EmbeddingEnergy energy(graphOf(l), adaptive_weights_, threads_);
    if (result_.report.added_barrier)
      energy.addBarrier(start.u);
    smooth(l, adaptive_weights_, kStartSweeps, {}, start.u);
    minimize(l, energy, kStartTolerance, std::nullopt, preconditioner, progress, start.u,
             start.report);
    start.value = energy.value(start.u);
    if (!result_.report.added_barrier)
      return;
    const double pull = pullOf(l, start.u);
    start.has_slipped = pull > kMaxPull;
    if (start.has_slipped)
      start.value = pull;
  }

  /// The best of several starts on the coarsest level, or the first on a finer one that does not
  /// collapse; without columns if all do. Each thread has starts of its own: only the calling one
  /// reports progress.
  ///
  /// \param rounds as often other starts are tried until one has not slipped.
  Positions solveStarts(std::size_t l, int rounds = 1) {
    const std::vector<Index> centers = centralNodes(graphOf(l));
    const auto starts_of_round = static_cast<std::size_t>(options_.starts);
    const std::size_t count =
        std::min(centers.size(), static_cast<std::size_t>(rounds) * starts_of_round);
    const bool is_coarsest = l == hierarchy_.levels.size();
    const auto most = static_cast<std::size_t>(threadCount(
        threads_, std::size_t{kMaxStartPasses} * graphOf(l).size(), kShortPassThreshold));
    const std::size_t threads = is_coarsest ? std::min(most, starts_of_round) : 1;
    std::vector<MultigridPreconditioner> preconditioners(threads, preconditionerOf(l));
    LevelReport best_report;
    Positions best;
    std::pair least(true, std::numeric_limits<double>::infinity());
    for (std::size_t first = 0; first < count && (is_coarsest || best.cols() == 0);) {
      const std::size_t in_round = first % starts_of_round;
      if (first > 0 && in_round == 0 && !least.first)
        break;
      std::vector<Start> starts(std::min({threads, starts_of_round - in_round, count - first}));
      for (Start& start : starts)
        start.report = levels()[l];
      reportFraction(report_, static_cast<double>(first) / static_cast<double>(count));
      std::atomic<bool> has_failed{false};
      forEachTask(starts.size(), static_cast<int>(threads), [&](std::size_t thread, std::size_t i) {
        const auto progress = [&](int, double) {
          if (thread == 0)
            reportFraction(report_, static_cast<double>(first) / static_cast<double>(count));
          else if (has_failed.load(std::memory_order_relaxed))
            throw AnotherFailed();
        };
        try {
          solveStart(l, centers[first + i], preconditioners[thread], progress, starts[i]);
        } catch (const AnotherFailed&) {
          // Its error is the one to report.
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
        if (isCollapsed(start.u, masses_[l]) || !std::isfinite(start.value)) {
          ++result_.collapsed_starts;
        } else if (std::pair(start.has_slipped, start.value) < least) {
          least = {start.has_slipped, start.value};
          best = std::move(start.u);
          has_slipped_ = start.has_slipped;
          best_report = start.report;
          best_center_ = centers[first + i];
        }
      }
      first += starts.size();
    }
    if (best.cols() > 0)
      levels()[l] = best_report;
    return best;
  }

  /// Unit vectors on a level between those of the next coarser one.
  Positions interpolated(std::size_t l, const Positions& coarse) const {
    const auto& weights = hierarchy_.levels[l].prolongation;
    const auto n = static_cast<std::size_t>(weights.rows());
    Positions u(3, weights.rows());
    forEachBlock(n, threadCount(threads_, n, kShortPassThreshold),
                 [&](std::size_t, std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) {
                     Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                     for (Index e = weights.outerIndexPtr()[i]; e < weights.outerIndexPtr()[i + 1];
                          ++e)
                       sum += weights.valuePtr()[e] * coarse.col(weights.innerIndexPtr()[e]);
                     u.col(static_cast<Eigen::Index>(i)) = sum.normalized();
                   }
                 });
    return u;
  }

  /// Damped Jacobi sweeps: `damping` times the tangential Laplacian, all nodes at once.
  void smooth(std::size_t l, const EdgeWeightLaw& weights, int sweeps, const FractionReport& swept,
              Positions& u) const {
    const Graph& graph = graphOf(l);
    const Rows rows =
        makeRows(graph, weights, threadCount(threads_, graph.size(), kShortPassThreshold));
    PaddedPositions current(4, u.cols());
    current.topRows<3>() = u;
    current.row(3).setZero();
    PaddedPositions next(4, u.cols());
    next.row(3).setZero();
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      reportFraction(swept, static_cast<double>(sweep) / sweeps);
      visitRule(rows, [&](auto rule) { sweepOnce<decltype(rule)::value>(rows, current, next); });
      std::swap(current, next);
    }
    u = current.topRows<3>();
  }

  template <WeightRule Rule>
  void sweepOnce(const Rows& rows, const PaddedPositions& current, PaddedPositions& next) const {
    // Along an edge the energy is p - 1 times as stiff as its weight: beyond p = 3 shorter steps.
    const double damping = Rule == WeightRule::Power
                               ? options_.damping * std::min(1.0, 2.0 / (options_.exponent - 1.0))
                               : options_.damping;
    const auto n = static_cast<std::size_t>(rows.size());
    forEachBlock(n, threadCount(threads_, n, kShortPassThreshold),
                 [&](std::size_t, std::size_t begin, std::size_t end) {
                   for (auto row = static_cast<Index>(begin); row < static_cast<Index>(end); ++row)
                     next.col(row).head<3>() =
                         (current.col(row).head<3>() +
                          damping * tangentialLaplacian<Rule>(rows, current, row))
                             .normalized();
                 });
  }

  /// Small systems are solved directly: no slower, and exact at all scales.
  MultigridPreconditioner preconditionerOf(std::size_t l) const {
    const bool direct = graphOf(l).size() <= kMaxDirectSize;
    return {hierarchy_, direct ? hierarchy_.levels.size() : l, threads_};
  }

  /// Newton's method on a level, until both tolerances are met.
  NewtonReport minimize(std::size_t l, const EmbeddingEnergy& energy, double relative_tolerance,
                        std::optional<double> tolerance, MultigridPreconditioner& preconditioner,
                        const std::function<void(int, double)>& progress, Positions& u,
                        LevelReport& report) const {
    NewtonOptions options;
    options.relative_tolerance = relative_tolerance;
    options.tolerance = tolerance.value_or(1.0);
    if (!energy.hasBarrier())
      options.longest_mean = kMaxStartCentroid;
    options.masses = masses_[l];
    options.progress = progress;
    NewtonReport newton = minimizeByNewton(energy, preconditioner, options, u);
    report.newton_iterations += newton.iterations;
    report.linear_iterations += newton.linear_iterations;
    report.residual = newton.residuals.back();
    return newton;
  }

  /// minimize() with a level's own report.
  NewtonReport solve(std::size_t l, const EmbeddingEnergy& energy, double relative_tolerance,
                     std::optional<double> tolerance, Positions& u) {
    const auto progress = [&](int iteration, double residual) {
      reportFraction(report_, 0.0);
      observe(l, EmbeddingStep::Newton, iteration, residual, u);
    };
    MultigridPreconditioner preconditioner = preconditionerOf(l);
    return minimize(l, energy, relative_tolerance, tolerance, preconditioner, progress, u,
                    levels()[l]);
  }

  /// Solves a level from an embedding that is not collapsed; adds a barrier if it becomes so. The
  /// graph itself may hold without that of coarser levels.
  NewtonReport solveUncollapsed(std::size_t l, std::optional<double> tolerance, Positions& u) {
    const bool is_freed =
        l == 0 && !weights_.needsBarrier() && std::exchange(result_.report.added_barrier, false);
    Positions solved = u;
    NewtonReport newton =
        solve(l, energyAt(l, u), is_freed ? kFreedTolerance : toleranceOf(l), tolerance, solved);
    if (isCollapsed(solved, masses_[l]) && !result_.report.added_barrier) {
      result_.report.added_barrier = true;
      hardly_pulls_ = false;
      collapsed_when_freed_ = is_freed;
      solved = u;
      newton = solve(l, energyAt(l, u), toleranceOf(l), tolerance, solved);
    }
    u = std::move(solved);
    return newton;
  }

  void finish(Positions& u) {
    EmbeddingReport& report = result_.report;
    if (options_.tolerance) {
      NewtonReport newton = solveUncollapsed(0, options_.tolerance, u);
      report.residuals = std::move(newton.residuals);
    }
    if (hardly_pulls_)
      report.added_barrier = false;
    report.residual = residualOf(0, u);
    levels()[0].residual = report.residual;
    report.iterations = report.residuals.empty() ? levels()[0].newton_iterations
                                                 : static_cast<int>(report.residuals.size()) - 1;
    result_.energy = energyWithout(0).value(u);
    // The Laplacian alone decides: where a barrier pulls, its solution has not converged.
    if (options_.tolerance)
      report.stop_reason =
          report.residual <= *options_.tolerance ? StopReason::Converged : StopReason::Stagnated;
    report.centroid_norm = centroidOf(u, masses_[0]).norm();
    if (isCollapsed(u, masses_[0]))
      report.stop_reason = StopReason::Collapsed;
    observe(0, EmbeddingStep::End, 0, report.residual, u);
    result_.directions = std::move(u);
  }

  const Graph& graph_;
  const GraphHierarchy& hierarchy_;
  const EmbeddingOptions& options_;
  const EmbeddingObserver& observer_;
  int threads_;
  EdgeWeightLaw weights_;
  EdgeWeightLaw adaptive_weights_;  ///< of the starts, whatever was chosen
  FractionReport report_;
  /// Of the centroid of each level; empty: all nodes alike.
  std::vector<Eigen::VectorXd> masses_;
  Embedding result_;
  /// The barrier is on coarser levels alone, and hardly pulls there: no finding.
  bool hardly_pulls_ = false;
  bool has_slipped_ = false;  ///< Start::has_slipped of the start that solveStarts() kept last
  bool has_tried_finer_ = false;
  bool collapsed_when_freed_ = false;  ///< the graph itself, of the barrier of coarser levels
  Index best_center_ = 0;              ///< of the start that solveStarts() kept last
};

}  // namespace

Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, NodeMass mass,
                        const EmbeddingObserver& observer, const Execution& execution) {
  return Solver(graph, hierarchy, options, mass, observer, execution).run();
}

}  // namespace spherical_param::internal
