#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <vector>

namespace spherical_param::internal {

/// A quadric of least squares through weighted points near an origin, as a height over the plane of
/// least squares.
class QuadricFit {
public:
  /// Coefficients of a height over a plane: 1, x, y, x^2, xy, y^2.
  static constexpr int kCoefficients = 6;

  /// With fewer points than coefficients height, normal and residual are 0.
  ///
  /// \param points  relative to the origin.
  /// \param weights of the points, of sum 1.
  void fit(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& weights);

  /// Normal of the plane. The height of the origin is along it.
  const Eigen::Vector3d& normal() const { return normal_; }
  /// Height of the origin above the quadric.
  double height() const { return height_; }
  /// Root mean square distance of the points from the quadric.
  double residual() const { return residual_; }
  /// 0 if the points are in a plane, 1 if all directions are alike.
  double roundness() const { return roundness_; }
  /// Variance of the quadric's height at the origin [variance of a single height of weight 1].
  double leverage() const;
  /// Distance of the origin from the nearest point, seen along the normal.
  double gap() const;

private:
  using Coefficients = Eigen::Matrix<double, kCoefficients, 1>;

  void findPlane(const std::vector<Eigen::Vector3d>& points, const std::vector<double>& weights);
  Coefficients monomialsAt(const Eigen::Vector3d& point) const;

  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 2> across_;
  Eigen::Matrix<double, kCoefficients, Eigen::Dynamic> rows_;
  Eigen::LDLT<Eigen::Matrix<double, kCoefficients, kCoefficients>> solver_;
  Coefficients at_origin_ = Coefficients::Zero();
  double height_ = 0.0;
  double residual_ = 0.0;
  double roundness_ = 1.0;
};

}  // namespace spherical_param::internal
