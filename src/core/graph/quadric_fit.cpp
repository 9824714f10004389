#include "quadric_fit.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spherical_param::internal {

void QuadricFit::fit(const std::vector<Eigen::Vector3d>& points,
                     const std::vector<double>& weights) {
  // Added to the normal equations, so that they are regular for any points.
  constexpr double ridge = 1e-9;
  normal_.setZero();
  height_ = 0.0;
  residual_ = 0.0;
  roundness_ = 1.0;
  if (points.size() < kCoefficients)
    return;
  findPlane(points, weights);
  rows_.resize(kCoefficients, static_cast<Eigen::Index>(points.size()));
  Eigen::Matrix<double, kCoefficients, kCoefficients> matrix;
  matrix.setZero();
  Coefficients right = Coefficients::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Coefficients row = monomialsAt(points[k]);
    rows_.col(static_cast<Eigen::Index>(k)) = row;
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(row, weights[k]);
    right += weights[k] * normal_.dot(points[k] - mean_) * row;
  }
  matrix.diagonal().array() += ridge;
  solver_.compute(matrix.selfadjointView<Eigen::Lower>());
  const Coefficients quadric = solver_.solve(right);
  double squares = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double residual =
        normal_.dot(points[k] - mean_) - quadric.dot(rows_.col(static_cast<Eigen::Index>(k)));
    squares += weights[k] * residual * residual;
  }
  residual_ = std::sqrt(squares);
  at_origin_ = monomialsAt(Eigen::Vector3d::Zero());
  height_ = -normal_.dot(mean_) - quadric.dot(at_origin_);
}

void QuadricFit::findPlane(const std::vector<Eigen::Vector3d>& points,
                           const std::vector<double>& weights) {
  mean_.setZero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    mean_ += weights[k] * points[k];
    covariance += weights[k] * points[k] * points[k].transpose();
  }
  covariance -= mean_ * mean_.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(covariance);
  normal_ = axes.eigenvectors().col(0);
  across_ = axes.eigenvectors().rightCols<2>();
  const Eigen::Vector3d& variances = axes.eigenvalues();
  if (variances[1] > 0.0)
    roundness_ = std::sqrt(std::max(variances[0], 0.0) / variances[1]);
}

double QuadricFit::leverage() const {
  return std::max(at_origin_.dot(solver_.solve(at_origin_)), 0.0);
}

double QuadricFit::gap() const {
  return (rows_.middleRows<2>(1).colwise() - at_origin_.segment<2>(1)).colwise().norm().minCoeff();
}

QuadricFit::Coefficients QuadricFit::monomialsAt(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d place = across_.transpose() * (point - mean_);
  const double x = place.x();
  const double y = place.y();
  return (Coefficients() << 1.0, x, y, x * x, x * y, y * y).finished();
}

}  // namespace spherical_param::internal
