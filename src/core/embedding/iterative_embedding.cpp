#include "iterative_embedding.h"

#include "collapse.h"
#include "embedding_starts.h"
#include "parallel.h"
#include "progress.h"
#include "space_filling_curve.h"
#include "tangential_laplacian.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Mean length of the tangential Laplacian at which the iteration has converged, unless asked for
/// another [radius].
constexpr double kTypicalTolerance = 1e-8;
/// The iteration stagnates where the residual varies by less than this over the window, relative.
constexpr double kMinChange = 1e-5;

/// The state of the iteration of Figure 3, on renumbered nodes, and its two passes over the nodes.
class Iteration {
public:
  Iteration(const Graph& graph, const Positions& directions, const EmbeddingOptions& options,
            const EdgeWeightLaw& weights, int threads)
      : rows_(makeRows(graph, mortonOrder(directions), weights)), damping_(options.damping),
        n_(static_cast<Index>(graph.size())),
        threads_(threadCount(threads, graph.size(), kShortPassThreshold)), u_(4, n_), moved_(4, n_),
        block_sums_((graph.size() + kBlockSize - 1) / kBlockSize),
        block_residuals_(block_sums_.size()) {
    for (Index row = 0; row < n_; ++row)
      u_.col(row) << directions.col(rows_.node_of_row[static_cast<std::size_t>(row)]), 0.0;
  }

  /// First pass: the tangential Laplacian of each node and the step from it.
  ///
  /// \return the mean length of the tangential Laplacian.
  double evaluate() {
    visitRule(rows_, [&](auto rule) {
      forEachBlock(static_cast<std::size_t>(n_), threads_,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     evaluateBlock<decltype(rule)::value>(block, begin, end);
                   });
    });
    mean_.setZero();
    for (const Eigen::Vector3d& sum : block_sums_)
      mean_ += sum;
    mean_ /= static_cast<double>(n_);
    return std::accumulate(block_residuals_.begin(), block_residuals_.end(), 0.0) /
           static_cast<double>(n_);
  }

  /// Second pass: takes the step, centres it and projects it on the sphere.
  void center() {
    forEachBlock(
        static_cast<std::size_t>(n_), threads_,
        [&](std::size_t, std::size_t begin, std::size_t end) {
          for (auto row = static_cast<Index>(begin); row < static_cast<Index>(end); ++row) {
            const Eigen::Vector3d moved = moved_.col(row).head<3>();
            const Eigen::Vector3d centered = moved - mean_;
            const double length = centered.norm();
            // At the very centre there is no direction: stay.
            u_.col(row).head<3>() = length > 0.0 ? Eigen::Vector3d(centered / length) : moved;
          }
        });
  }

  Positions directions() const {
    Positions result(3, n_);
    for (Index row = 0; row < n_; ++row)
      result.col(rows_.node_of_row[static_cast<std::size_t>(row)]) = u_.col(row).head<3>();
    return result;
  }

private:
  template <WeightRule Rule>
  void evaluateBlock(std::size_t block, std::size_t begin, std::size_t end) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double residual = 0.0;
    for (auto row = static_cast<Index>(begin); row < static_cast<Index>(end); ++row) {
      const Eigen::Vector3d step = tangentialLaplacian<Rule>(rows_, u_, row);
      residual += step.norm();
      // Never zero: the step is orthogonal to a unit vector.
      const Eigen::Vector3d moved = (u_.col(row).head<3>() + damping_ * step).normalized();
      moved_.col(row).head<3>() = moved;
      sum += moved;
    }
    block_sums_[block] = sum;
    block_residuals_[block] = residual;
  }

  Rows rows_;
  double damping_;
  Index n_;
  int threads_;
  PaddedPositions u_;      ///< unit vectors, centred before their projection
  PaddedPositions moved_;  ///< unit vectors after the step
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();  ///< of `moved_`
  std::vector<Eigen::Vector3d> block_sums_;
  std::vector<double> block_residuals_;
};

bool hasStagnated(const std::vector<double>& residuals, int stagnation_window) {
  const auto window = static_cast<std::size_t>(stagnation_window);
  if (window < 2 || residuals.size() <= window)
    return false;
  const auto [low, high] =
      std::minmax_element(residuals.end() - static_cast<std::ptrdiff_t>(window), residuals.end());
  return *high - *low <= kMinChange * *high;
}

}  // namespace

Embedding embedIteratively(const Graph& graph, const Positions& start,
                           const EmbeddingOptions& options, const EmbeddingObserver& observer,
                           const Execution& execution) {
  Embedding result;
  EmbeddingReport& report = result.report;
  const EdgeWeightLaw weights(options.weights, options.exponent);
  Iteration iteration(graph, projectFromCentroid(start), options, weights, execution.threads);
  report.residuals.reserve(static_cast<std::size_t>(std::min(options.max_iterations, 100000)) + 1);
  const FractionReport report_progress = reportOf(execution, "embedding");
  for (;;) {
    report.residual = iteration.evaluate();
    reportFraction(report_progress, report.iterations / (options.max_iterations + 1.0));
    report.residuals.push_back(report.residual);
    if (observer)
      observer({0, graph.size(), EmbeddingStep::Iteration, report.iterations, report.residual,
                [&] { return iteration.directions(); }});
    if (report.residual <= options.tolerance.value_or(kTypicalTolerance))
      report.stop_reason = StopReason::Converged;
    else if (report.iterations >= options.max_iterations)
      report.stop_reason = StopReason::IterationLimit;
    else if (hasStagnated(report.residuals, options.stagnation_window))
      report.stop_reason = StopReason::Stagnated;
    else {
      ++report.iterations;
      iteration.center();
      continue;
    }
    break;
  }
  result.directions = iteration.directions();
  report.centroid_norm = result.directions.rowwise().mean().norm();
  // Judged at the end only: the centring undoes a passing collapse within a few steps.
  if (isCollapsed(result.directions))
    report.stop_reason = StopReason::Collapsed;
  if (observer)
    observer({0, graph.size(), EmbeddingStep::End, report.iterations, report.residual,
              [&] { return result.directions; }});
  return result;
}

}  // namespace spherical_param::internal
