#pragma once

#include "corner_table.h"
#include "exact_predicates.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

#include <cmath>

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

/// Whether all triangles around a vertex are outward with it at a place of the sphere; exact.
inline bool fitsAt(const Eigen::Vector3d& place, Index v, const Positions& sphere,
                   const Triangles& triangles, const CornerTable& corners) {
  bool fits = true;
  corners.forEachCorner(v, [&](Index t, Index k) {
    fits = fits && isOutward(place, sphere.col(triangles(nextCorner(k), t)),
                             sphere.col(triangles(previousCorner(k), t)));
  });
  return fits;
}

/// The weighted sum of the values at a triangle's corners.
template <typename Columns>
Eigen::Vector3d blend(const Columns& columns, const Triangles& triangles, Eigen::Index t,
                      const Eigen::Vector3d& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k)
    sum += weights[k] * columns.col(triangles(k, t));
  return sum;
}

/// Weights scaled to sum 1; those of the middle if all are 0 by rounding.
inline Eigen::Vector3d withSumOne(const Eigen::Vector3d& weights) {
  if (weights.sum() > 0.0)
    return weights / weights.sum();
  return Eigen::Vector3d::Constant(1.0 / 3.0);
}

/// Whether a triangle on the sphere is clockwise or has no area there; exact.
inline bool isFlipped(const Positions& sphere, const Triangles& triangles, Eigen::Index t) {
  return !isOutward(sphere.col(triangles(0, t)), sphere.col(triangles(1, t)),
                    sphere.col(triangles(2, t)));
}

/// Outward unit normals of the vertices of a closed mesh: normals of the triangles, weighted by
/// angle, so that the triangulation does not matter (G. Thuermer and C. A. Wuethrich, 1998).
///
/// \param sphere 3 x v, unit vectors: normals of vertices whose triangles have no area.
inline Positions vertexNormals(const Positions& points, const Triangles& triangles,
                               const Positions& sphere, const CornerTable& corners, int threads) {
  const auto count = columnCount(points);
  Positions normals(3, points.cols());
  forEachIndex(count, threadCount(threads, count), {}, [&](Index v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    corners.forEachCorner(v, [&](Index t, Index k) {
      const Eigen::Vector3d a = points.col(triangles(nextCorner(k), t)) - points.col(v);
      const Eigen::Vector3d b = points.col(triangles(previousCorner(k), t)) - points.col(v);
      const Eigen::Vector3d normal = a.cross(b);
      const double length = normal.norm();
      if (length > 0.0)
        sum += std::atan2(length, a.dot(b)) / length * normal;
    });
    const double length = sum.norm();
    if (length > 0.0)
      normals.col(v) = sum / length;
    else
      normals.col(v) = sphere.col(v);
  });
  return normals;
}

/// Points at most 1 from the origin in each coordinate: squares of lengths are in the range of
/// double, whatever the unit.
inline Positions scaledToUnit(Positions points) {
  const Eigen::Vector3d center =
      0.5 * points.rowwise().minCoeff() + 0.5 * points.rowwise().maxCoeff();
  points.colwise() -= center;
  const double extent = points.cwiseAbs().maxCoeff();
  if (extent > 0.0)
    points /= extent;
  return points;
}

}  // namespace spherical_param::internal
