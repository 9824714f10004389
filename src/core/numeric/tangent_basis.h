#pragma once

#include <Eigen/Core>

#include <cmath>

namespace spherical_param::internal {

/// Two orthonormal tangent vectors at a point of the sphere; with the second as x and the first as
/// y axis, right-handed seen from inside.
using TangentBasis = Eigen::Matrix<double, 3, 2>;

/// J. R. Frisvad: "Building an Orthonormal Basis from a 3D Unit Vector Without Normalization",
/// 2012, in the form of T. Duff et al.: "Building an Orthonormal Basis, Revisited", 2017.
///
/// \param u unit vector.
inline TangentBasis tangentBasis(const Eigen::Vector3d& u) {
  const double sign = std::copysign(1.0, u.z());
  const double a = -1.0 / (sign + u.z());
  const double b = u.x() * u.y() * a;
  TangentBasis basis;
  basis.col(0) << 1.0 + sign * u.x() * u.x() * a, sign * b, -sign * u.x();
  basis.col(1) << b, sign + u.y() * u.y() * a, -u.y();
  return basis;
}

}  // namespace spherical_param::internal
