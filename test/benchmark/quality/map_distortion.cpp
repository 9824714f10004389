#include "mesh_quality.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::benchmark {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector3d;

/// A triangle by two of its sides, from the same corner.
struct Sides {
  Vector3d first;
  Vector3d second;

  double area() const { return 0.5 * first.cross(second).norm(); }
  /// The sides as columns, in a frame whose first axis is the first side.
  Matrix2d inPlane() const {
    const double length = first.norm();
    Matrix2d sides;
    sides << length, first.dot(second) / length, 0.0, 2.0 * area() / length;
    return sides;
  }
};

Sides sidesOf(const Positions& points, const Triangles& triangles, Eigen::Index t) {
  const Vector3d corner = points.col(triangles(0, t));
  return {points.col(triangles(1, t)) - corner, points.col(triangles(2, t)) - corner};
}

/// The value of a triangle and its weight.
using Weighted = std::pair<double, double>;

/// The smallest value up to which there is a fraction of all weight.
double percentile(std::vector<Weighted>& values, double fraction) {
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& [value, weight] : values)
    total += weight;
  double sum = 0.0;
  for (const auto& [value, weight] : values) {
    sum += weight;
    if (sum >= fraction * total)
      return value;
  }
  return values.back().first;
}

/// Smallest distance of a corner of a spherical triangle from the great circle through the others
/// [as sine], negative if the triangle is seen clockwise from outside.
double smallestAltitude(const Positions& sphere, const Triangles& triangles, Eigen::Index t) {
  const Sides sides = sidesOf(sphere, triangles, t);
  const Vector3d corner = sphere.col(triangles(0, t));
  const Vector3d next = sphere.col(triangles(1, t));
  // Products with differences: the positions themselves cancel in small triangles.
  const double widest =
      std::max({corner.cross(sides.first).norm(), corner.cross(sides.second).norm(),
                next.cross(sides.second - sides.first).norm()});
  return widest > 0.0 ? corner.dot(sides.first.cross(sides.second)) / widest : 0.0;
}

/// Six times the volume of the tetrahedron of a triangle and an apex.
double signedVolume(const Mesh& mesh, Eigen::Index t, const Vector3d& apex) {
  const Sides sides = sidesOf(mesh.points, mesh.triangles, t);
  return (mesh.points.col(mesh.triangles(0, t)) - apex).dot(sides.first.cross(sides.second));
}

/// A triangle whose smallest altitude is not more than this may have been turned over by the
/// rounding to float alone. Coordinates up to 1 are rounded by 2^-25 at most, positions by sqrt(3)
/// times that; and an altitude changes by what its corner and the side opposite to it move.
constexpr double kRoundedAway = 0x1p-23;

}  // namespace

MapDistortion measureMapDistortion(const Mesh& mesh, const Positions& on_sphere) {
  // A length that is only nearly 1 would tilt small triangles.
  const Positions sphere = on_sphere.colwise().normalized();
  const Vector3d center = mesh.points.rowwise().mean();
  double volume = 0.0;
  double area_in_space = 0.0;
  double area_on_sphere = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    area_in_space += sidesOf(mesh.points, mesh.triangles, t).area();
    area_on_sphere += sidesOf(sphere, mesh.triangles, t).area();
    volume += signedVolume(mesh, t, center);
  }
  const double outward = volume < 0.0 ? -1.0 : 1.0;

  MapDistortion distortion;
  std::vector<Weighted> angles;
  double weights = 0.0;
  double angle_sum = 0.0;
  double area_sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const double altitude = outward * smallestAltitude(sphere, mesh.triangles, t);
    if (!(std::abs(altitude) > kRoundedAway)) {
      ++distortion.collapsed_triangles;
      continue;
    }
    distortion.inverted_triangles += altitude < 0.0 ? 1 : 0;
    const Sides solid = sidesOf(mesh.points, mesh.triangles, t);
    const double weight = solid.area();
    if (!(weight > 0.0))
      continue;
    const Sides flat = sidesOf(sphere, mesh.triangles, t);
    const Matrix2d map = flat.inPlane() * solid.inPlane().inverse();
    const Eigen::Vector2d stretch = Eigen::JacobiSVD<Matrix2d>(map).singularValues();
    const double angle = stretch[0] / stretch[1];
    const double area = std::log2(flat.area() / area_on_sphere * (area_in_space / weight));
    if (!std::isfinite(angle) || !std::isfinite(area))
      continue;
    angles.emplace_back(angle, weight);
    weights += weight;
    angle_sum += weight * angle;
    area_sum += weight * area * area;
  }
  if (angles.empty())
    return distortion;
  distortion.angle_mean = angle_sum / weights;
  distortion.angle_p95 = percentile(angles, 0.95);
  distortion.area_rms_log2 = std::sqrt(area_sum / weights);
  return distortion;
}

}  // namespace spherical_param::benchmark
