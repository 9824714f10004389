#include "spherical_param/sphere_embedding.h"

#include "spherical_param/errors.h"

#include "graph_checks.h"
#include "option_checks.h"
#include "parallel.h"
#include "space_filling_curve.h"
#include "tangential_laplacian.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

using internal::PaddedPositions;
using internal::Rows;
using internal::WeightRule;

/// A collapse: this share of the nodes within this distance of one direction.
constexpr double kCollapsedShare = 0.9;
constexpr double kCollapsedRadius = 0.01;

void checkInput(const Graph& graph, const Positions& start, const EmbeddingOptions& options) {
  const auto fail = [](const std::string& what) { throw InvalidInput("embedOnSphere: " + what); };
  internal::checkGraph("embedOnSphere", graph);
  if (static_cast<std::size_t>(start.cols()) != graph.size())
    fail(std::to_string(start.cols()) + " start positions for a graph of " +
         std::to_string(graph.size()) + " nodes; give one for each");
  if (!start.allFinite())
    fail("a start position is not finite; remove such points first");
  internal::checkEnum("embedOnSphere: weights", options.weights, EdgeWeights::Adaptive);
  if (!(options.lambda > 0.0 && options.lambda <= 1.0))
    fail("lambda = " + std::to_string(options.lambda) + " is out of range; use (0, 1]");
  if (options.max_iterations < 0)
    fail("max_iterations = " + std::to_string(options.max_iterations) + "; use 0 or more");
  if (!(options.tolerance >= 0.0))
    fail("tolerance = " + std::to_string(options.tolerance) + "; use 0 or more");
  if (options.stagnation_window < 0 || options.stagnation_window == 1)
    fail("stagnation_window = " + std::to_string(options.stagnation_window) +
         "; use 2 or more, or 0 to never stop for stagnation");
  if (!(options.stagnation_change >= 0.0))
    fail("stagnation_change = " + std::to_string(options.stagnation_change) + "; use 0 or more");
  if (options.threads < 0 || options.threads > internal::kMostThreads)
    fail("threads = " + std::to_string(options.threads) + " is out of range; use 0 (all) to " +
         std::to_string(internal::kMostThreads));
}

/// The points about their centroid, scaled first: neither the sum nor the squares may overflow.
///
/// \param points 3 x n, finite, n >= 1.
Positions scaledAndCentered(const Positions& points) {
  const double scale = std::max(points.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  Positions centered = points / scale;
  centered.colwise() -= Eigen::Vector3d(centered.rowwise().mean());
  return centered;
}

/// A direction for node i where none is defined, spread evenly over the sphere by the golden angle.
Eigen::Vector3d anyDirection(Index i, Index n) {
  const double height = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
  const double golden_angle = std::acos(-1.0) * (3.0 - std::sqrt(5.0));
  const double angle = golden_angle * static_cast<double>(i);
  const double radius = std::sqrt(std::max(0.0, 1.0 - height * height));
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

/// Tells whether nearly all points are around one direction.
bool isCollapsed(const Positions& u) {
  const Eigen::Vector3d mean = u.rowwise().mean();
  // The points of a collapse alone make the mean longer than this.
  if (!(mean.norm() > kCollapsedShare * (1.0 - kCollapsedRadius) - (1.0 - kCollapsedShare)))
    return false;
  const Eigen::Vector3d direction = mean.normalized();
  const auto near = ((u.colwise() - direction).colwise().norm().array() < kCollapsedRadius).count();
  return static_cast<double>(near) >= kCollapsedShare * static_cast<double>(u.cols());
}

/// The state of the iteration of Figure 3, on renumbered nodes, and its two passes over the nodes.
class Iteration {
public:
  Iteration(const Graph& graph, const Positions& directions, const EmbeddingOptions& options)
      : rows_(internal::makeRows(graph, internal::mortonOrder(directions),
                                 options.weights == EdgeWeights::Uniform)),
        adaptive_(options.weights == EdgeWeights::Adaptive), lambda_(options.lambda),
        n_(static_cast<Index>(graph.size())),
        threads_(
            internal::threadCount(options.threads, graph.size(), internal::kShortPassThreshold)),
        u_(4, n_), moved_(4, n_),
        block_sums_((graph.size() + internal::kBlockSize - 1) / internal::kBlockSize),
        block_residuals_(block_sums_.size()) {
    for (Index row = 0; row < n_; ++row)
      u_.col(row) << directions.col(rows_.node_of_row[static_cast<std::size_t>(row)]), 0.0;
  }

  /// First pass: the tangential Laplacian of each node and the step from it.
  ///
  /// \return the mean length of the tangential Laplacian.
  double evaluate() {
    internal::forEachBlock(static_cast<std::size_t>(n_), threads_,
                           [&](std::size_t block, std::size_t begin, std::size_t end) {
                             if (adaptive_)
                               evaluateBlock<WeightRule::Linear>(block, begin, end);
                             else
                               evaluateBlock<WeightRule::Fixed>(block, begin, end);
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
    internal::forEachBlock(
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
      const Eigen::Vector3d step = internal::tangentialLaplacian<Rule>(rows_, u_, row);
      residual += step.norm();
      // Never zero: the step is orthogonal to a unit vector.
      const Eigen::Vector3d moved = (u_.col(row).head<3>() + lambda_ * step).normalized();
      moved_.col(row).head<3>() = moved;
      sum += moved;
    }
    block_sums_[block] = sum;
    block_residuals_[block] = residual;
  }

  Rows rows_;
  bool adaptive_;
  double lambda_;
  Index n_;
  int threads_;
  PaddedPositions u_;      ///< unit vectors, centred before their projection
  PaddedPositions moved_;  ///< unit vectors after the step
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();  ///< of `moved_`
  std::vector<Eigen::Vector3d> block_sums_;
  std::vector<double> block_residuals_;
};

bool hasStagnated(const std::vector<double>& residuals, const EmbeddingOptions& options) {
  const auto window = static_cast<std::size_t>(options.stagnation_window);
  if (window == 0 || residuals.size() <= window)
    return false;
  const auto [low, high] =
      std::minmax_element(residuals.end() - static_cast<std::ptrdiff_t>(window), residuals.end());
  return *high - *low <= options.stagnation_change * *high;
}

}  // namespace

Positions projectFromCentroid(const Positions& points) {
  const auto n = static_cast<Index>(points.cols());
  if (n == 0)
    return points;
  Positions directions = scaledAndCentered(points);
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector3d centered = directions.col(i);
    const double length = centered.stableNorm();
    directions.col(i) =
        length > 0.0 ? Eigen::Vector3d((centered / length).normalized()) : anyDirection(i, n);
  }
  return directions;
}

Positions projectByRank(const Positions& points) {
  const auto n = static_cast<Index>(points.cols());
  if (n == 0)
    return points;
  const Positions centered = scaledAndCentered(points);
  const Eigen::Matrix3d covariance = centered * centered.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  // Ascending eigenvalues: the last axis is the longest.
  const Positions local = axes.eigenvectors().transpose() * centered;
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    return std::pair(local(2, i), i) < std::pair(local(2, j), j);
  });
  Positions directions(3, n);
  for (Index rank = 0; rank < n; ++rank) {
    const Index i = order[static_cast<std::size_t>(rank)];
    const double height = (2.0 * rank + 1.0) / n - 1.0;
    const double radius = std::sqrt(1.0 - height * height);
    const Eigen::Vector2d around = local.col(i).head<2>().stableNormalized();
    if (around.squaredNorm() > 0.5)
      directions.col(i) << radius * around.x(), radius * around.y(), height;
    else
      directions.col(i) << radius, 0.0, height;
    directions.col(i).normalize();
  }
  return directions;
}

Embedding embedOnSphere(const Graph& graph, const Positions& start,
                        const EmbeddingOptions& options) {
  checkInput(graph, start, options);
  Embedding result;
  if (graph.size() == 0) {
    result.stop_reason = StopReason::Converged;
    result.directions = start;
    return result;
  }
  Iteration iteration(graph, projectFromCentroid(start), options);
  result.residuals.reserve(static_cast<std::size_t>(std::min(options.max_iterations, 100000)) + 1);
  for (;;) {
    result.residual = iteration.evaluate();
    if (options.progress && !options.progress(result.iterations, result.residual))
      throw Cancelled("embedOnSphere: cancelled by the progress callback");
    result.residuals.push_back(result.residual);
    if (options.observer)
      options.observer({0, graph.size(), EmbeddingStep::Iteration, result.iterations,
                        result.residual, [&] { return iteration.directions(); }});
    if (result.residual <= options.tolerance)
      result.stop_reason = StopReason::Converged;
    else if (result.iterations >= options.max_iterations)
      result.stop_reason = StopReason::IterationLimit;
    else if (hasStagnated(result.residuals, options))
      result.stop_reason = StopReason::Stagnated;
    else {
      ++result.iterations;
      iteration.center();
      continue;
    }
    break;
  }
  result.directions = iteration.directions();
  result.centroid_norm = result.directions.rowwise().mean().norm();
  // Judged at the end only: the centring undoes a passing collapse within a few steps.
  if (isCollapsed(result.directions))
    result.stop_reason = StopReason::Collapsed;
  if (options.observer)
    options.observer({0, graph.size(), EmbeddingStep::End, result.iterations, result.residual,
                      [&] { return result.directions; }});
  return result;
}

std::vector<double> tangentialLaplacianLengths(const Graph& graph, const Positions& directions,
                                               EdgeWeights weights, double exponent) {
  internal::checkEnum("tangentialLaplacianLengths: weights", weights, EdgeWeights::Adaptive);
  internal::checkGraph("tangentialLaplacianLengths", graph);
  if (static_cast<std::size_t>(directions.cols()) != graph.size())
    throw InvalidInput("tangentialLaplacianLengths: " + std::to_string(directions.cols()) +
                       " directions for a graph of " + std::to_string(graph.size()) +
                       " nodes; give one for each");
  std::vector<double> lengths(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const Eigen::Vector3d center = directions.col(static_cast<Eigen::Index>(i));
    Eigen::Vector3d laplacian = Eigen::Vector3d::Zero();
    double weight_sum = 0.0;
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e) {
      const Eigen::Vector3d edge = directions.col(graph.neighbors[e]) - center;
      double weight = 1.0;
      if (weights == EdgeWeights::InverseLength)
        weight = 1.0 / graph.lengths[e];
      else if (weights == EdgeWeights::Adaptive)
        weight = std::pow(edge.norm() / graph.lengths[e], exponent - 2.0);
      laplacian += weight * edge;
      weight_sum += weight;
    }
    if (weight_sum > 0.0)
      laplacian /= weight_sum;
    lengths[i] = (laplacian - laplacian.dot(center) * center).norm();
  }
  return lengths;
}

double meanTangentialLaplacian(const Graph& graph, const Positions& directions, EdgeWeights weights,
                               double exponent) {
  const std::vector<double> lengths =
      tangentialLaplacianLengths(graph, directions, weights, exponent);
  return lengths.empty() ? 0.0
                         : std::accumulate(lengths.begin(), lengths.end(), 0.0) /
                               static_cast<double>(lengths.size());
}

}  // namespace spherical_param
