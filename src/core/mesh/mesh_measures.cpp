#include "spherical_param/mesh_measures.h"

#include "corner_table.h"
#include "parallel.h"

#include <Eigen/Geometry>

#include <cmath>

namespace spherical_param {
namespace {

/// Sums over a mesh, with corners relative to an origin.
struct SolidSums {
  double volume = 0.0;                               // 6 times the volume
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // 24 times the integral of x over the solid
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // 120 times the integral of x x^T
};
struct SurfaceSums {
  double area = 0.0;                                // 2 times the area
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // 6 times the integral of x over the mesh
  double length = 0.0;                              // of the sides of all triangles
  Eigen::Vector3d box_min, box_max;
};

Eigen::Matrix3d cornersOf(const Positions& points, const Triangles& triangles, Eigen::Index t,
                          const Eigen::Vector3d& origin) {
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k)
    corners.col(k) = points.col(triangles(k, t)) - origin;
  return corners;
}

SolidSums sumOverSolid(const Positions& points, const Triangles& triangles,
                       const Eigen::Vector3d& origin) {
  SolidSums sums;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = cornersOf(points, triangles, t, origin);
    // Over the tetrahedron of the corners and the origin, x integrates to det / 24 times their sum,
    // and x x^T to det / 120 times the sum of the products of any two of them.
    const double determinant = corners.col(0).dot(corners.col(1).cross(corners.col(2)));
    sums.volume += determinant;
    const Eigen::Vector3d sum = corners.rowwise().sum();
    sums.first += determinant * sum;
    sums.second += determinant * (sum * sum.transpose() + corners * corners.transpose());
  }
  return sums;
}

SurfaceSums sumOverSurface(const Positions& points, const Triangles& triangles,
                           const Eigen::Vector3d& origin) {
  SurfaceSums sums;
  sums.box_min = origin;
  sums.box_max = origin;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = cornersOf(points, triangles, t, origin);
    const double twice_area = internal::areaNormal(points, triangles, t).norm();
    sums.area += twice_area;
    sums.first += twice_area * corners.rowwise().sum();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = points.col(triangles(k, t));
      sums.box_min = sums.box_min.cwiseMin(corner);
      sums.box_max = sums.box_max.cwiseMax(corner);
      sums.length += (corners.col((k + 1) % 3) - corners.col(k)).norm();
    }
  }
  return sums;
}

}  // namespace

MeshMeasures measureMesh(const Positions& points, const Triangles& triangles,
                         int requested_threads) {
  internal::checkThreads(requested_threads);
  internal::checkTriangles("measureMesh", triangles, points.cols());
  MeshMeasures measures;
  if (triangles.cols() == 0)
    return measures;
  const Eigen::Vector3d origin = points.col(triangles(0, 0));
  SolidSums solid;
  SurfaceSums surface;
  // Each sum has one thread, which adds in the order of the triangles.
  const int threads = internal::threadCount(requested_threads, internal::columnCount(triangles));
  internal::forEachTask(2, threads, [&](std::size_t part) {
    if (part == 0)
      solid = sumOverSolid(points, triangles, origin);
    else
      surface = sumOverSurface(points, triangles, origin);
  });
  measures.box_min = surface.box_min;
  measures.box_max = surface.box_max;
  measures.volume = solid.volume / 6.0;
  measures.area = surface.area / 2.0;
  // Each edge is a side of two triangles: the mean over sides is the mean over edges.
  measures.mean_edge_length = surface.length / (3.0 * static_cast<double>(triangles.cols()));

  const double diagonal = (measures.box_max - measures.box_min).norm();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // from the origin of the sums
  // A smaller volume is rounding: the centroid would be the quotient of two errors.
  if (std::abs(measures.volume) > 1e-12 * diagonal * diagonal * diagonal)
    center = solid.first / (24.0 * measures.volume);
  else if (measures.area > 0.0)
    center = surface.first / (6.0 * measures.area);
  measures.centroid = origin + center;

  // By the parallel axis theorem, for any center: that of the surface is not that of the solid.
  const Eigen::Matrix3d mixed = solid.first / 24.0 * center.transpose();
  const Eigen::Matrix3d covariance = solid.second / 120.0 - mixed - mixed.transpose() +
                                     measures.volume * center * center.transpose();
  measures.inertia = covariance.trace() * Eigen::Matrix3d::Identity() - covariance;
  return measures;
}

Positions areaWeightedNormals(const Positions& points, const Triangles& triangles) {
  internal::checkTriangles("areaWeightedNormals", triangles, points.cols());
  Positions normals = Positions::Zero(3, points.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d normal = internal::areaNormal(points, triangles, t);
    for (Eigen::Index k = 0; k < 3; ++k)
      normals.col(triangles(k, t)) += normal;
  }
  return normals;
}

}  // namespace spherical_param
