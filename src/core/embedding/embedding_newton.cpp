#include "embedding_newton.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace spherical_param::internal {
namespace {

/// No cloud needs as many: they end systems that never converge.
constexpr int kMaxLinearIterations = 200;
constexpr int kMaxHalvings = 40;
/// A longer step could jump over the barrier to the collapsed state, whose energy is 0 [rad].
/// Without a bound, 9 of the 52 meshes of multilevel_embedding.cpp intersect themselves instead
/// of 8.
constexpr double kMaxStep = 0.3;
/// Conjugate gradients measure their progress by energy, to which small parts of the embedding add
/// nothing. Where the relative residual lags behind the absolute one by this factor, each step is
/// refined by this number of V-cycles, which treat all scales alike. With any lag, 10 of the 52
/// meshes intersect themselves; without refinement, self-intersections of two spheres grow by a
/// fifth.
constexpr double kMaxLag = 4.0;
constexpr int kRefinements = 4;
/// The residual must fall by this factor where rounding hides the change of the energy. With 1, the
/// self-intersections of two spheres grow by a seventh.
constexpr double kMaxResidualRatio = 0.9;

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
                const TangentVector& step, double fraction) {
  Positions result(3, u.cols());
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    result.col(i) =
        (u.col(i) + bases[static_cast<std::size_t>(i)] * (fraction * step.segment<2>(2 * i)))
            .normalized();
  return result;
}

/// An embedding with what Newton's method knows of it.
struct Iterate {
  Positions directions;
  Positions gradient;
  EmbeddingEnergy::Residual residual;
  double value = 0.0;  ///< of the energy
};

/// The first iterate along a step, halved again and again, with sufficient decrease (L. Armijo,
/// 1966); where the energy no longer changes beyond rounding, the residual has to fall instead.
///
/// \param expected decrease of the energy by the whole step, to first order.
/// \return nothing if rounding leaves no such step.
std::optional<Iterate> searchLine(const EmbeddingEnergy& energy, const Iterate& current,
                                  const std::vector<TangentBasis>& bases, const TangentVector& step,
                                  double expected) {
  const double rounding = 1e-14 * std::abs(current.value) + 1e-300;
  double fraction = std::min(1.0, kMaxStep / longest(step));
  for (int halving = 0; halving < kMaxHalvings; ++halving, fraction /= 2.0) {
    Iterate trial;
    trial.directions = moved(current.directions, bases, step, fraction);
    trial.value = energy.value(trial.directions);
    if (!std::isfinite(trial.value))
      continue;
    const double change = trial.value - current.value;
    const bool is_rounding = std::abs(change) <= rounding;
    if (!is_rounding && !(change <= 1e-4 * fraction * expected))
      continue;
    trial.residual = energy.gradient(trial.directions, trial.gradient);
    if (is_rounding && !(trial.residual.absolute < kMaxResidualRatio * current.residual.absolute ||
                         trial.residual.relative < kMaxResidualRatio * current.residual.relative))
      continue;
    return trial;
  }
  return std::nullopt;
}

}  // namespace

NewtonReport minimizeByNewton(const EmbeddingEnergy& energy,
                              MultigridPreconditioner& preconditioner, const NewtonOptions& options,
                              Positions& directions) {
  NewtonReport report;
  Iterate current;
  current.residual = energy.gradient(directions, current.gradient);
  current.value = energy.value(directions);
  current.directions = directions;
  double reduction = 0.1;
  int refinements = 0;
  EmbeddingEnergy::Hessian hessian;
  for (;;) {
    const EmbeddingEnergy::Residual& residual = current.residual;
    report.residuals.push_back(residual.absolute);
    if (options.progress)
      options.progress(report.iterations, residual.absolute);
    const bool converged =
        residual.absolute <= options.tolerance && residual.relative <= options.relative_tolerance;
    const bool collapses = options.collapses && options.collapses(current.directions);
    if (converged || collapses || report.iterations >= options.max_iterations)
      break;

    const std::vector<TangentBasis> bases = tangentBases(current.directions);
    energy.hessian(current.directions, bases, hessian);
    preconditioner.compute(hessian.matrix, bases);
    const TangentVector slope = inBases(bases, current.gradient);
    const LinearSolution solution = conjugateGradients(
        hessian, bases, preconditioner, slope, {reduction, refinements, kMaxLinearIterations});
    report.linear_iterations += solution.iterations;
    std::optional<Iterate> next =
        searchLine(energy, current, bases, solution.x, slope.dot(solution.x));
    if (!next)
      break;
    // S. C. Eisenstat, H. F. Walker: "Choosing the Forcing Terms in an Inexact Newton Method",
    // 1996, choice 2; no more accurate than the tolerance needs.
    const double ratio = next->residual.absolute / residual.absolute;
    reduction = std::clamp(0.9 * ratio * ratio, 1e-4, 0.1);
    if (next->residual.relative > options.relative_tolerance &&
        next->residual.relative > kMaxLag * ratio * residual.relative)
      refinements = kRefinements;
    current = std::move(*next);
    directions = current.directions;  // for the observer of the progress
    ++report.iterations;
  }
  return report;
}

}  // namespace spherical_param::internal
