#pragma once

#include "corner_table.h"
#include "exact_predicates.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

namespace spherical_param::internal {

/// Exact sign of the determinant | a, b, c | of directions.
inline int determinantSign(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c) {
  return orientation3d(Eigen::Vector3d::Zero(), a, b, c);
}

/// Whether directions are counter-clockwise on the sphere, seen from outside; exact.
inline bool isOutward(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c) {
  return determinantSign(a, b, c) > 0;
}

/// Whether a triangle on the sphere is clockwise or has no area there; exact.
inline bool isFlipped(const Positions& sphere, const Triangles& triangles, Eigen::Index t) {
  return !isOutward(sphere.col(triangles(0, t)), sphere.col(triangles(1, t)),
                    sphere.col(triangles(2, t)));
}

}  // namespace spherical_param::internal
