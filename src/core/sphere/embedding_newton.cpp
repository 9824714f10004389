#include "embedding_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spherical_param::internal {
namespace {

double dot(const Positions& x, const Positions& y) {
  return x.cwiseProduct(y).sum();
}

/// Projects vectors onto the tangent planes of the directions.
void project(const Positions& directions, Positions& x) {
  // Evaluated before x changes.
  const Eigen::RowVectorXd heights = directions.cwiseProduct(x).colwise().sum();
  x -= directions * heights.asDiagonal();
}

/// An embedding with its energy and derivatives.
struct Iterate {
  Positions directions;
  Positions gradient;
  EmbeddingEnergy::Residual residual;
  double value = 0.0;  ///< of the energy
};

/// Halves a step until the energy decreases sufficiently (L. Armijo, 1966). If rounding hides the
/// change of the energy, the residual has to fall instead.
///
/// \param expected change of the energy by the whole step, to first order.
/// \return the next iterate; nothing if rounding leaves no such step.
std::optional<Iterate> searchLine(const EmbeddingEnergy& energy, const Iterate& current,
                                  const Positions& step, double expected) {
  constexpr int max_halvings = 40;
  // A longer step could jump over the barrier to the collapsed state, whose energy is 0 [rad].
  constexpr double max_step = 0.3;
  // The residual must fall by this factor if rounding hides the change of the energy.
  constexpr double max_residual_ratio = 0.9;
  const double rounding = 1e-14 * std::abs(current.value) + 1e-300;
  double fraction = std::min(1.0, max_step / step.colwise().norm().maxCoeff());
  for (int halving = 0; halving < max_halvings; ++halving, fraction /= 2.0) {
    Iterate trial;
    trial.directions = (current.directions + fraction * step).colwise().normalized();
    trial.value = energy.value(trial.directions);
    if (!std::isfinite(trial.value))
      continue;
    const double change = trial.value - current.value;
    const bool is_rounding = std::abs(change) <= rounding;
    if (!is_rounding && !(change <= 1e-4 * fraction * expected))
      continue;
    trial.residual = energy.gradient(trial.directions, trial.gradient);
    if (is_rounding && !(trial.residual.absolute < max_residual_ratio * current.residual.absolute ||
                         trial.residual.relative < max_residual_ratio * current.residual.relative))
      continue;
    return trial;
  }
  return std::nullopt;
}

/// Solves Hessian x = -gradient by preconditioned conjugate gradients. Ends early at a direction of
/// negative curvature (T. Steihaug, 1983). The result is always a descent direction.
///
/// \param reduction   of the residual, in the norm of the preconditioner.
/// \param refinements number of V-cycles afterwards, each on the remaining residual.
/// \param iterations  grows by the number of iterations.
Positions conjugateGradients(const EmbeddingEnergy& energy, const Iterate& iterate,
                             const LaplacianCycle& preconditioner, double reduction,
                             int refinements, int& iterations) {
  const Positions& u = iterate.directions;
  const auto precondition = [&](const Positions& b) {
    Positions x = preconditioner.apply(b);
    project(u, x);
    return x;
  };
  // Ends systems that do not converge.
  constexpr int max_linear_iterations = 200;
  Positions x = Positions::Zero(3, u.cols());
  Positions residual = -iterate.gradient;
  Positions direction = precondition(residual);
  Positions product;
  double square = dot(residual, direction);
  const double goal = reduction * reduction * square;
  for (int i = 0; i < max_linear_iterations && square > goal; ++i) {
    energy.multiplyHessian(u, direction, product);
    const double curvature = dot(direction, product);
    if (!(curvature > 0.0)) {
      if (i == 0)
        x = direction;
      break;
    }
    x += square / curvature * direction;
    residual -= square / curvature * product;
    ++iterations;
    const Positions preconditioned = precondition(residual);
    const double next = dot(residual, preconditioned);
    direction = preconditioned + next / square * direction;
    square = next;
  }
  for (int i = 0; i < refinements; ++i) {
    energy.multiplyHessian(u, x, product);
    x += precondition(-iterate.gradient - product);
  }
  return x;
}

}  // namespace

std::vector<double> minimizeByNewton(const EmbeddingEnergy& energy, LaplacianCycle& preconditioner,
                                     const NewtonOptions& options, Positions& directions,
                                     LevelReport& report) {
  // Conjugate gradients measure their progress by energy, to which small parts of the embedding
  // hardly contribute. If the relative residual lags behind the absolute one by this factor, four
  // V-cycles refine each step, since they treat all scales alike.
  constexpr double max_lag = 4.0;
  constexpr int max_iterations = 100;
  std::vector<double> residuals;
  Iterate current;
  current.residual = energy.gradient(directions, current.gradient);
  current.value = energy.value(directions);
  current.directions = directions;
  double reduction = 0.1;
  int refinements = 0;
  for (int iteration = 0;; ++iteration) {
    const EmbeddingEnergy::Residual& residual = current.residual;
    residuals.push_back(residual.absolute);
    reportFraction(options.report, 0.0);
    const bool converged = residual.absolute <= options.tolerance.value_or(1.0) &&
                           residual.relative <= options.relative_tolerance;
    const bool collapses = options.collapses && options.collapses(current.directions);
    if (converged || collapses || iteration >= max_iterations)
      break;

    preconditioner.compute(energy.laplacian(current.directions));
    const Positions step = conjugateGradients(energy, current, preconditioner, reduction,
                                              refinements, report.linear_iterations);
    std::optional<Iterate> next = searchLine(energy, current, step, dot(current.gradient, step));
    if (!next)
      break;
    // S. C. Eisenstat, H. F. Walker: "Choosing the Forcing Terms in an Inexact Newton Method",
    // 1996, choice 2; no more accurate than the tolerance needs.
    const double ratio = next->residual.absolute / residual.absolute;
    reduction = std::clamp(0.9 * ratio * ratio, 1e-4, 0.1);
    if (next->residual.relative > options.relative_tolerance &&
        next->residual.relative > max_lag * ratio * residual.relative)
      refinements = 4;
    current = std::move(*next);
    ++report.newton_iterations;
  }
  directions = std::move(current.directions);
  report.residual = residuals.back();
  return residuals;
}

}  // namespace spherical_param::internal
