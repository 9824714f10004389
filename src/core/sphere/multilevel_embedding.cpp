#include "multilevel_embedding.h"

#include "level_solver.h"
#include "planar_start.h"
#include "progress.h"
#include "tangential_laplacian.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace spherical_param::internal {
namespace {

// The experiments that count meshes are on 13 models and 13 shapes of up to 60,000 points, each
// also with the graph of nearest neighbours: 8 of these 52 meshes intersect themselves. With
// uniform weights and with a tolerance there are 104 meshes, of which 13 intersect themselves.

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
/// that is freed of the barrier of its levels has a way to go: of 12 seeds of the springer 5 end
/// with an RMS above 0.05 % with 1e-3, 4 with 3e-4, 3 with 3e-5.
constexpr double kStartTolerance = 3e-3;
constexpr double kLevelTolerance = 1e-3;
constexpr double kGraphTolerance = 1e-2;
constexpr double kFreedTolerance = 3e-5;
/// The sphere drifts off a wide gap without folding what is left, and a barrier that only stops
/// this drift leaves at most this relative residual without it: 0.003 to 0.056 on most bodies that
/// are cut, thinned or have holes. Where the sphere has slipped off a limb, the barrier holds the
/// folded rest, by 0.068 or more on tubes between two balls: without a bound, these and 9 other
/// shapes have 6,904,781 self-intersections after the first flips instead of 206,919. With 0, the
/// springer takes 210 ms instead of 60, half of an armadillo 4.7 s instead of 0.25.
constexpr double kMaxPull = 0.06;

/// How an embedding is attempted.
struct EmbeddingAttempt {
  std::size_t level;         ///< on which it starts: 0 is the graph itself
  EmbeddingBarrier barrier;  ///< where it has one
  std::size_t starts;        ///< maximum number of starts
  std::size_t compared;      ///< number of accepted starts of which the best is kept
};

/// One attempt at an embedding.
class Ascent {
public:
  Ascent(const EmbeddingLevels& levels, const EmbeddingAttempt& attempt,
         const EmbeddingOptions& options, const Execution& execution)
      : levels_(levels), attempt_(attempt), options_(options),
        report_(reportOf(execution, "embedding")) {
    for (std::size_t l = 0; l <= levels.coarsest(); ++l)
      result_.report.levels.push_back(untried(l));
  }

  /// The embedding; nothing if it is not accepted.
  std::optional<Embedding> run() {
    std::optional<Positions> u = bestStart();
    if (!u)
      return std::nullopt;
    for (std::size_t l = attempt_.level; l-- > 0;)
      refine(l, *u);
    if (options_.tolerance)
      result_.report.residuals = solve(0, options_.tolerance, *u);
    if (!isAccepted(0, *u))
      return std::nullopt;
    finish(*u);
    return std::move(result_);
  }

private:
  LevelReport untried(std::size_t l) const {
    LevelReport report;
    report.nodes = levels_.graph(l).size();
    report.edges = levels_.graph(l).edgeCount();
    return report;
  }

  /// The one test: an embedding of a level has not collapsed, and no barrier pulls hard at it.
  bool isAccepted(std::size_t l, const Positions& u) const {
    return !isCollapsed(levels_.centroid(l, u)) &&
           (attempt_.barrier == EmbeddingBarrier::Everywhere || levels_.pull(l, u) <= kMaxPull);
  }

  /// What the best start has least of: energy, or where a barrier may pull hard, its pull. A folded
  /// rest has little energy: by it, eight dumbbells of 2,000 points have 6,695 intersections,
  /// not 3.
  double valueOf(std::size_t l, const Positions& u) const {
    return attempt_.barrier == EmbeddingBarrier::Everywhere ? levels_.pull(l, u)
                                                            : levels_.energy(l, u);
  }

  /// The best of the first starts that are accepted.
  std::optional<Positions> bestStart() {
    const std::size_t l = attempt_.level;
    const std::vector<Index> centers = centralNodes(levels_.graph(l));
    const std::size_t most = std::min(centers.size(), attempt_.starts);
    std::optional<Positions> best;
    double least = std::numeric_limits<double>::infinity();
    std::size_t accepted = 0;
    LevelReport& kept = result_.report.levels[l];
    for (std::size_t i = 0; i < most && accepted < attempt_.compared; ++i) {
      reportFraction(report_, static_cast<double>(i) / static_cast<double>(most));
      Positions u = planarStart(levels_.graph(l), centers[i]);
      LevelReport work = untried(l);
      solveStart(u, work);
      if (!isAccepted(l, u))
        continue;
      ++accepted;
      const double value = valueOf(l, u);
      if (!(value < least))
        continue;
      least = value;
      best = std::move(u);
      kept = work;
    }
    return best;
  }

  /// Solves a planar start. Its barrier is that of the start before the sweeps, which is stronger:
  /// with that after them, a cut penguin has 42 intersections instead of 12 (mean of five seeds).
  void solveStart(Positions& u, LevelReport& work) const {
    // Smoothing sweeps on a planar start, whose edges are far from their lengths. With 0, 9 of the
    // 52 intersect themselves.
    constexpr int start_sweeps = 3;
    const Positions planar = u;
    levels_.smooth(attempt_.level, start_sweeps, {}, u);
    work.sweeps = start_sweeps;
    levels_.solve(attempt_.level, hasBarrier(attempt_.level) ? &planar : nullptr,
                  {kStartTolerance, std::nullopt}, u, work);
  }

  /// Takes the embedding to the next finer level.
  void refine(std::size_t l, Positions& u) {
    LevelReport& work = result_.report.levels[l];
    u = levels_.interpolated(l, u);
    work.residual = levels_.smooth(l, kSweeps, report_, u);
    work.sweeps = kSweeps;
    if (work.nodes <= kMaxSolvedSize && !(l == 0 && options_.tolerance))
      solve(l, std::nullopt, u);
  }

  /// Solves a level on the way up.
  std::vector<double> solve(std::size_t l, std::optional<double> tolerance, Positions& u) {
    const double relative_tolerance = l > 0 ? kLevelTolerance
                                      : attempt_.barrier == EmbeddingBarrier::CoarseLevels
                                          ? kFreedTolerance
                                          : kGraphTolerance;
    return levels_.solve(l, hasBarrier(l) ? &u : nullptr, {relative_tolerance, tolerance, report_},
                         u, result_.report.levels[l]);
  }

  /// Whether there is a barrier on a level. A graph without coarser levels has it on itself.
  bool hasBarrier(std::size_t l) const {
    return attempt_.barrier == EmbeddingBarrier::Everywhere ||
           (attempt_.barrier == EmbeddingBarrier::CoarseLevels &&
            (l > 0 || levels_.coarsest() == 0));
  }

  void finish(Positions& u) {
    EmbeddingReport& report = result_.report;
    report.start_level = attempt_.level;
    report.barrier = hasBarrier(0) ? EmbeddingBarrier::Everywhere : attempt_.barrier;
    report.residual = meanTangentialLaplacian(levels_.graph(0), u, EdgeWeights::Adaptive);
    report.levels[0].residual = report.residual;
    report.iterations = report.residuals.empty() ? report.levels[0].newton_iterations
                                                 : static_cast<int>(report.residuals.size()) - 1;
    // The Laplacian alone decides: where a barrier pulls, its solution has not converged.
    if (options_.tolerance)
      report.stop_reason =
          report.residual <= *options_.tolerance ? StopReason::Converged : StopReason::Stagnated;
    report.centroid_norm = levels_.centroid(0, u).norm();
    result_.directions = std::move(u);
  }

  const EmbeddingLevels& levels_;
  const EmbeddingAttempt& attempt_;
  const EmbeddingOptions& options_;
  FractionReport report_;
  Embedding result_;
};

/// The attempts at an embedding, in the order in which they are made.
///
/// 1. The start on the coarsest level.
/// 2. The same with a barrier on all levels but the graph itself, and with more starts. It helps
///    graphs of a few nodes and with wide gaps, on which all starts collapse.
/// 3. Starts on finer and finer levels: the fewer nodes are around a limb, the easier the sphere
///    slips off it.
/// 4. The barrier also on the graph itself, however hard it pulls.
std::vector<EmbeddingAttempt> attemptsOf(const EmbeddingLevels& levels) {
  // Largest level on which an attempt starts; the bound limits the time: a start takes up to
  // 200 us a node. None of 578 clouds needs more than 4,312; with 100,000, scans of 300,000 points
  // take 10 to 14 s instead of 5.
  constexpr std::size_t max_start_size = 5000;
  constexpr std::size_t few = 2;
  // With a barrier, starts fail more often. With 2, an elephant from eight depth images folds with
  // one seed of nine.
  constexpr std::size_t many = 8;
  const std::size_t coarsest = levels.coarsest();
  std::vector<EmbeddingAttempt> attempts = {{coarsest, EmbeddingBarrier::None, few, few},
                                            {coarsest, EmbeddingBarrier::CoarseLevels, many, few}};
  for (std::size_t l = coarsest; l-- > 0 && levels.graph(l).size() <= max_start_size;)
    attempts.push_back({l, EmbeddingBarrier::None, few, 1});
  attempts.push_back({coarsest, EmbeddingBarrier::Everywhere, few, few});
  return attempts;
}

}  // namespace

Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                        const EmbeddingOptions& options, const Execution& execution) {
  const EmbeddingLevels levels(graph, hierarchy, execution.threads);
  for (const EmbeddingAttempt& attempt : attemptsOf(levels))
    if (std::optional<Embedding> embedding = Ascent(levels, attempt, options, execution).run())
      return std::move(*embedding);
  Embedding none;
  none.report.stop_reason = StopReason::Collapsed;
  return none;
}

}  // namespace spherical_param::internal
