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

/// Number of smoothing sweeps on each level.
constexpr int kSweeps = 10;
/// Levels of at most this number of nodes are solved, not only smoothed.
constexpr std::size_t kMaxSolvedSize = 10000;
/// Relative residuals to which a start, a level and the graph itself are solved. Limbs shrink
/// exponentially along the sphere, so no absolute tolerance would show whether their tips are
/// solved. Coarser starts and levels give folded meshes, finer ones take longer. A graph without
/// the barrier that its levels had (freed) moves far, and needs a lower tolerance.
constexpr double kStartTolerance = 3e-3;
constexpr double kLevelTolerance = 1e-3;
constexpr double kGraphTolerance = 1e-2;
constexpr double kFreedTolerance = 3e-5;
/// Maximum pull of a barrier, \see EmbeddingLevels::pull. A barrier that only keeps the sphere from
/// drifting off a wide gap pulls by 0.003 to 0.056. If the sphere has slipped off a limb, it holds
/// the folded rest, and pulls by 0.068 or more.
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

  /// Whether an embedding of a level has not collapsed, and no barrier pulls hard at it.
  bool isAccepted(std::size_t l, const Positions& u) const {
    return !isCollapsed(levels_.centroid(l, u)) &&
           (attempt_.barrier == EmbeddingBarrier::Everywhere || levels_.pull(l, u) <= kMaxPull);
  }

  /// The best start has the least energy, or, where a barrier may pull hard, the least pull: a
  /// folded rest has little energy.
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

  /// Solves a planar start. Its barrier is that before the sweeps, which is stronger.
  void solveStart(Positions& u, LevelReport& work) const {
    // Number of smoothing sweeps, since the edges of a planar start are far from their lengths.
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
///    graphs with few nodes or wide gaps, on which all starts collapse.
/// 3. Starts on finer and finer levels: the sphere slips off a limb more easily if fewer nodes are
///    around it.
/// 4. The barrier also on the graph itself, however hard it pulls.
std::vector<EmbeddingAttempt> attemptsOf(const EmbeddingLevels& levels) {
  // Maximum number of nodes of a level on which an attempt starts; limits the time.
  constexpr std::size_t max_start_size = 5000;
  constexpr std::size_t few = 2;
  constexpr std::size_t many = 8;  // starts fail more often with a barrier
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
