#include "embedding_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spherical_param::internal {
namespace {

constexpr int kMostLinearIterations = 200;
constexpr int kMostHalvings = 40;
constexpr double kLongestStep = 0.3;  ///< [rad]
/// Conjugate gradients measure their progress by energy, to which small parts of the embedding add
/// nothing. Where the relative residual lags behind the absolute one by this factor, each step is
/// refined by so many V-cycles, which treat all scales alike.
constexpr double kLag = 4.0;
constexpr int kRefinements = 4;
/// A residual has to fall by this factor where the energy no longer tells.
constexpr double kProgress = 0.9;

TangentVector inBases(const std::vector<TangentBasis>& bases, const Positions& ambient) {
  TangentVector result(2 * ambient.cols());
  for (Eigen::Index i = 0; i < ambient.cols(); ++i)
    result.segment<2>(2 * i) = bases[static_cast<std::size_t>(i)].transpose() * ambient.col(i);
  return result;
}

/// Length of the longest of the nodes' vectors.
double longest(const TangentVector& x) {
  return Eigen::Map<const Eigen::Matrix2Xd>(x.data(), 2, x.size() / 2).colwise().norm().maxCoeff();
}

Positions moved(const Positions& u, const std::vector<TangentBasis>& bases,
                const TangentVector& step, double share) {
  Positions result(3, u.cols());
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    result.col(i) =
        (u.col(i) + bases[static_cast<std::size_t>(i)] * (share * step.segment<2>(2 * i)))
            .normalized();
  return result;
}

}  // namespace

NewtonReport minimizeByNewton(const EmbeddingEnergy& energy,
                              MultigridPreconditioner& preconditioner, const NewtonOptions& options,
                              Positions& directions) {
  NewtonReport report;
  Positions gradient;
  EmbeddingEnergy::Residual residual = energy.gradient(directions, gradient);
  double value = energy.value(directions);
  double reduction = 0.1;
  int refinements = 0;
  EmbeddingEnergy::Hessian hessian;
  for (;;) {
    report.residuals.push_back(residual.absolute);
    if (options.progress)
      options.progress(report.iterations, residual.absolute);
    const bool converged =
        residual.absolute <= options.tolerance && residual.relative <= options.relative_tolerance;
    const bool collapses = directions.rowwise().mean().norm() > options.longest_mean;
    if (converged || collapses || report.iterations >= options.max_iterations)
      return report;

    const std::vector<TangentBasis> bases = tangentBases(directions);
    energy.hessian(directions, bases, hessian);
    preconditioner.compute(hessian.matrix, bases);
    const TangentVector slope = inBases(bases, gradient);
    const LinearSolution solution = conjugateGradients(
        hessian, bases, preconditioner, slope, {reduction, refinements, kMostLinearIterations});
    report.linear_iterations += solution.iterations;

    // Sufficient decrease (L. Armijo, 1966); where the energy no longer changes beyond rounding,
    // the residual has to fall instead.
    const double expected = slope.dot(solution.x);
    const double noise = 1e-14 * std::abs(value) + 1e-300;
    bool accepted = false;
    // A longer step could jump over the barrier to the collapsed state, whose energy is 0.
    double share = std::min(1.0, kLongestStep / longest(solution.x));
    for (int halving = 0; halving < kMostHalvings && !accepted; ++halving, share /= 2.0) {
      Positions trial = moved(directions, bases, solution.x, share);
      const double trial_value = energy.value(trial);
      if (!std::isfinite(trial_value))
        continue;
      const double change = trial_value - value;
      const bool is_noise = std::abs(change) <= noise;
      if (!is_noise && !(change <= 1e-4 * share * expected))
        continue;
      Positions trial_gradient;
      const EmbeddingEnergy::Residual trial_residual = energy.gradient(trial, trial_gradient);
      if (is_noise && !(trial_residual.absolute < kProgress * residual.absolute ||
                        trial_residual.relative < kProgress * residual.relative))
        continue;
      // S. C. Eisenstat, H. F. Walker: "Choosing the Forcing Terms in an Inexact Newton Method",
      // 1996, choice 2; no more accurate than the tolerance needs.
      const double ratio = trial_residual.absolute / residual.absolute;
      reduction = std::clamp(0.9 * ratio * ratio, 1e-4, 0.1);
      const bool lags = trial_residual.relative > options.relative_tolerance &&
                        trial_residual.relative > kLag * ratio * residual.relative;
      if (lags)
        refinements = kRefinements;
      directions = std::move(trial);
      gradient = std::move(trial_gradient);
      residual = trial_residual;
      value = trial_value;
      accepted = true;
    }
    if (!accepted)
      return report;
    ++report.iterations;
  }
}

}  // namespace spherical_param::internal
