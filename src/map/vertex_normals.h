#pragma once

#include "corner_table.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>

namespace spherical_param::internal {

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

}  // namespace spherical_param::internal
