#pragma once

#include <Eigen/Core>

namespace spherical_param::internal {

/// Coefficients of a height over a plane: 1, x, y, x^2, xy, y^2.
using Quadric = Eigen::Matrix<double, 6, 1>;

inline Quadric monomials(double x, double y) {
  return (Quadric() << 1.0, x, y, x * x, x * y, y * y).finished();
}

}  // namespace spherical_param::internal
