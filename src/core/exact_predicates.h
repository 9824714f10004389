#pragma once

#include <Eigen/Core>

namespace spherical_param::internal {

/// Sign of the determinant | b - a, c - a | of points in the plane, exact unless products of
/// coordinate differences leave the range of double: 1 counter-clockwise, 0 collinear, -1
/// clockwise.
int orientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// Sign of the determinant | b - a, c - a, d - a |, exact unless products of coordinate
/// differences leave the range of double: 0 if the four points lie in one plane.
int orientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& d);

}  // namespace spherical_param::internal
