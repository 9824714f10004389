#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace spherical_param::internal {

/// Multiplies by 2^exponent; exact unless the result is denormal.
class PowerOfTwo {
public:
  explicit PowerOfTwo(int exponent) : exponent_(exponent), factor_(std::ldexp(1.0, exponent)) {}

  double operator()(double x) const {
    // Beyond, the factor itself is not a normal number.
    return std::abs(exponent_) < 1000 ? x * factor_ : std::ldexp(x, exponent_);
  }
  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const {
    return {(*this)(x[0]), (*this)(x[1]), (*this)(x[2])};
  }

private:
  int exponent_;
  double factor_;
};

/// A power of two that brings coordinates of at most this size to 1/2 ... 1: the exact predicates
/// multiply three differences.
inline double scaleToUnit(double most) {
  int exponent = 0;
  std::frexp(most, &exponent);
  return std::ldexp(1.0, std::min(-exponent, 1000));
}

/// Exponent of the smallest power of two that is larger than half of the largest extent along an
/// axis; 0 without any.
inline int exponentOfExtent(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  int exponent = 0;
  const double extent = (high - low).maxCoeff();
  if (std::isfinite(extent)) {
    std::frexp(extent, &exponent);
    return extent > 0.0 ? exponent - 1 : 0;
  }
  // The difference of two huge coordinates; that of their halves is finite.
  std::frexp((high / 2.0 - low / 2.0).maxCoeff(), &exponent);
  return exponent;
}

}  // namespace spherical_param::internal
