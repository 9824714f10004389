#pragma once

#include "spherical_param/types.h"

#include <Eigen/Eigenvalues>

namespace spherical_param::internal {

/// The middle of the box around points.
inline Eigen::Vector3d middleOf(const Positions& points) {
  return (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2.0;
}

/// The diagonal of the box around points.
inline double extentOf(const Positions& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

/// Axes of the spread of points, the shortest first, and their variances.
inline Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axesOf(const Positions& points) {
  const Positions centered = points.colwise() - points.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
      Eigen::Matrix3d(centered * centered.transpose()));
}

/// Moves a place along axes while a cost falls; then halves the step, down to `min_step`.
///
/// \param max_moves with each step.
/// \return the cost at the last place.
template <typename Cost>
double descend(const Cost& cost, const Eigen::Matrix3d& axes, double step, double min_step,
               int max_moves, Eigen::Vector3d& place) {
  double best = cost(place);
  while (step > min_step) {
    for (int k = 0, failed = 0, moves = 0; failed < 6 && moves < max_moves;) {
      const Eigen::Vector3d other = place + (k % 2 == 0 ? step : -step) * axes.col(k / 2);
      if (const double found = cost(other); found < best) {
        best = found;
        place = other;
        failed = 0;
        ++moves;
      } else {
        k = (k + 1) % 6;
        ++failed;
      }
    }
    step /= 2.0;
  }
  return best;
}

}  // namespace spherical_param::internal
