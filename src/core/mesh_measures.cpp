#include "spherical_param/mesh_measures.h"

#include "core/corner_table.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spherical_param {
namespace {

/// Volumes below this share of the box's diagonal cubed are rounding: a centroid would be the
/// quotient of two errors.
constexpr double kLeastVolume = 1e-12;

}  // namespace

MeshMeasures measureMesh(const Positions& points, const Triangles& triangles) {
  MeshMeasures measures;
  internal::checkTriangles("measureMesh", triangles, points.cols());
  if (triangles.cols() == 0)
    return measures;

  const Eigen::Vector3d origin = points.col(triangles(0, 0));
  measures.box_min = origin;
  measures.box_max = origin;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // 24 times the integral of x over the solid
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // 120 times the integral of x x^T
  Eigen::Vector3d of_surface = Eigen::Vector3d::Zero();  // 6 times the integral of x over the mesh
  // Those of signedVolume() and surfaceArea(), in one go with the rest.
  double volume = 0.0;
  double area = 0.0;
  double length = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = points.col(triangles(k, t));
      measures.box_min = measures.box_min.cwiseMin(corner);
      measures.box_max = measures.box_max.cwiseMax(corner);
      corners.col(k) = corner - origin;
    }
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d ab = points.col(triangles(1, t)) - a;
    const Eigen::Vector3d ac = points.col(triangles(2, t)) - a;
    area += ab.cross(ac).norm();
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    // The tetrahedron of the triangle and the origin: its moments are those of its corners, over
    // which x integrates to det / 24 of their sum, and x x^T to det / 120 of the products of each
    // two of them, both with the origin as the fourth corner.
    const double determinant = corners.col(0).dot(corners.col(1).cross(corners.col(2)));
    volume += determinant;
    const Eigen::Vector3d sum = corners.rowwise().sum();
    first += determinant * sum;
    second += determinant * (sum * sum.transpose() + corners * corners.transpose());
    of_surface += normal.norm() * sum;
    for (int k = 0; k < 3; ++k)
      length += (corners.col((k + 1) % 3) - corners.col(k)).norm();
  }
  measures.volume = volume / 6.0;
  measures.area = area / 2.0;
  // Each edge is a side of two triangles: the mean over sides is the mean over edges.
  measures.mean_edge_length = length / (3.0 * static_cast<double>(triangles.cols()));

  const double diagonal = (measures.box_max - measures.box_min).norm();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // from the origin of the sums
  if (std::abs(measures.volume) > kLeastVolume * diagonal * diagonal * diagonal)
    center = first / (24.0 * measures.volume);
  else if (measures.area > 0.0)
    center = of_surface / (6.0 * measures.area);
  measures.centroid = origin + center;

  // About the centroid, by the parallel axis theorem; written for any point, as the centroid of the
  // surface is not that of the solid.
  const Eigen::Matrix3d mixed = first / 24.0 * center.transpose();
  const Eigen::Matrix3d covariance =
      second / 120.0 - mixed - mixed.transpose() + measures.volume * center * center.transpose();
  measures.inertia = covariance.trace() * Eigen::Matrix3d::Identity() - covariance;
  return measures;
}

}  // namespace spherical_param
