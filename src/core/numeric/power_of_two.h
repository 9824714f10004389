#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace spherical_param::internal {

/// x * 2^exponent, of each coefficient; exact unless the result is denormal.
template <typename Derived>
typename Derived::PlainObject timesPowerOfTwo(const Eigen::MatrixBase<Derived>& x, int exponent) {
  return x.unaryExpr([exponent](double number) { return std::ldexp(number, exponent); });
}

/// The power of two that scales a coordinate of this size to 1/2 ... 1, so that products of three
/// differences do not overflow.
inline double scaleToUnit(double most) {
  int exponent = 0;
  std::frexp(most, &exponent);
  return std::ldexp(1.0, std::min(-exponent, 1000));
}

/// Exponent of the smallest power of two that is larger than half of the largest extent along an
/// axis; 0 without any.
inline int exponentOfExtent(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  int exponent = 0;
  // Halves: the difference of two huge coordinates may be beyond the range of double.
  std::frexp((high / 2.0 - low / 2.0).maxCoeff(), &exponent);
  return exponent;
}

}  // namespace spherical_param::internal
