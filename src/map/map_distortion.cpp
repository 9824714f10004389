#include "spherical_param/map/sphere_map.h"

#include "corner_table.h"
#include "index_loops.h"
#include "spherical_param/errors.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

/// Values that are not finite count as 1e300, so that means are finite: a triangle that is
/// collapsed on the sphere has no finite distortion.
double bounded(double value) {
  return std::fmin(value, 1e300);
}

/// A triangle by two of its sides, from the same corner.
struct Sides {
  Vector3d first;
  Vector3d second;
  double twice_area;

  Sides(const Positions& points, const Triangles& triangles, Eigen::Index t, double scale)
      : first((points.col(triangles(1, t)) - points.col(triangles(0, t))) * scale),
        second((points.col(triangles(2, t)) - points.col(triangles(0, t))) * scale),
        twice_area(first.cross(second).norm()) {}

  double longestSquared() const {
    return std::max({first.squaredNorm(), second.squaredNorm(), (second - first).squaredNorm()});
  }
  /// Whether the area is rounding of the cross product.
  bool isDegenerate() const {
    return !(twice_area > 16.0 * std::numeric_limits<double>::epsilon() * longestSquared());
  }

  /// Angles at the corners [rad].
  Vector3d angles() const {
    const Vector3d third = second - first;
    return {std::atan2(twice_area, first.dot(second)), std::atan2(twice_area, -first.dot(third)),
            std::atan2(twice_area, second.dot(third))};
  }
};

/// The sides of a triangle in its plane: the first is (length, 0), the second (x, height).
struct InPlane {
  double length;
  double x;
  double height;

  explicit InPlane(const Sides& sides)
      : length(sides.first.norm()),
        x(length > 0.0 ? sides.first.dot(sides.second) / length : sides.second.norm()),
        height(length > 0.0 ? sides.twice_area / length : 0.0) {}
};

/// The greater singular value of the linear map from one triangle, not degenerate, to another, and
/// its determinant without sign.
struct LinearMap {
  double sigma_1;
  double determinant;

  LinearMap(const Sides& from, const Sides& to) {
    const InPlane source(from);
    const InPlane image(to);
    const double a = image.length / source.length;
    const double b = (image.x - a * source.x) / source.height;
    const double d = image.height / source.height;
    // sigma_1 + sigma_2 and sigma_1 - sigma_2 are the moduli of the conformal and the anticonformal
    // part.
    sigma_1 = 0.5 * (std::hypot(a + d, b) + std::hypot(a - d, b));
    determinant = to.twice_area / from.twice_area;
  }
};

/// A triangle's value and its weight.
using Weighted = std::pair<double, double>;

DistortionStatistics statisticsOf(std::vector<Weighted>& values) {
  DistortionStatistics statistics;
  if (values.empty())
    return statistics;
  std::sort(values.begin(), values.end());
  double total = 0.0;
  for (const auto& [value, weight] : values)
    total += weight;
  double sum = 0.0;
  statistics.max = values.back().first;
  statistics.p95 = statistics.max;
  bool found = false;
  for (const auto& [value, weight] : values) {
    statistics.mean += weight / total * value;
    sum += weight;
    if (!found && sum >= 0.95 * total) {
      statistics.p95 = value;
      found = true;
    }
  }
  return statistics;
}

/// Sums over triangles.
struct Sums {
  double in_space = 0.0;   // twice the area of those with an area
  double on_sphere = 0.0;  // the same of their flat images
  double covered = 0.0;    // area on the sphere of these
  Index flipped = 0;
  Index degenerate = 0;

  Sums& operator+=(const Sums& other) {
    in_space += other.in_space;
    on_sphere += other.on_sphere;
    covered += other.covered;
    flipped += other.flipped;
    degenerate += other.degenerate;
    return *this;
  }
};

void checkPositions(const Positions& points, const Triangles& triangles, const Positions& sphere) {
  const std::string caller = "measureMapDistortion: ";
  if (points.cols() != sphere.cols())
    throw InvalidInput(caller + "there are " + std::to_string(points.cols()) + " points, but " +
                       std::to_string(sphere.cols()) +
                       " directions on the sphere; give one for each point");
  internal::checkTriangles("measureMapDistortion", triangles, points.cols());
  if (!points.allFinite() || !sphere.allFinite())
    throw InvalidInput(caller + "a coordinate is not finite; remove such points first");
}

/// The triangles of a mesh, in space and on the sphere, and what sums over them have in common.
struct Meshes {
  const Positions& points;
  const Positions& sphere;
  const Triangles& triangles;
  double scale;  ///< of the points: no square of a length leaves the range of double
  int threads;

  Sides solid(Index t) const { return Sides(points, triangles, t, scale); }
  Sides flat(Index t) const { return Sides(sphere, triangles, t, 1.0); }
  /// Area of the spherical triangle between the corners of an image, without sign: the solid angle
  /// (A. van Oosterom and J. Strackee, 1983).
  double areaOnSphere(Index t, const Sides& sides) const {
    const Vector3d corner = sphere.col(triangles(0, t));
    const double determinant = corner.dot(sides.first.cross(sides.second));
    // 1 + ab + bc + ca of unit vectors, by differences.
    const double denominator = 4.0 - 0.5 * (sides.first.squaredNorm() + sides.second.squaredNorm() +
                                            (sides.second - sides.first).squaredNorm());
    return 2.0 * std::atan2(std::abs(determinant), denominator);
  }
};

Sums sumsOf(const Meshes& meshes) {
  return internal::accumulate(internal::columnCount(meshes.triangles), meshes.threads, Sums(),
                              [&](Index t, Sums& sums) {
                                const Sides solid = meshes.solid(t);
                                if (internal::isFlipped(meshes.sphere, meshes.triangles, t))
                                  ++sums.flipped;
                                if (solid.isDegenerate()) {
                                  ++sums.degenerate;
                                  return;
                                }
                                sums.in_space += solid.twice_area;
                                const Sides flat = meshes.flat(t);
                                sums.on_sphere += flat.twice_area;
                                sums.covered += meshes.areaOnSphere(t, flat);
                              });
}

/// Distortions of all triangles that are not degenerate, and sums over them.
struct Distortions {
  std::vector<Weighted> angles;
  std::vector<Weighted> areas;
  double angle_difference = 0.0;  ///< sum over the corners [rad]
  double squared_stretch = 0.0;   ///< mean
};

Distortions distortionsOf(const Meshes& meshes, const Sums& sums) {
  const std::size_t count = internal::columnCount(meshes.triangles);
  constexpr Weighted none(-1.0, 0.0);
  internal::Indexed<Weighted> angles(count, none);
  internal::Indexed<Weighted> areas(count, none);
  // Differences of angles, and the squares of stretch.
  const Eigen::Array2d totals = internal::accumulate(
      count, meshes.threads, Eigen::Array2d(0.0, 0.0), [&](Index t, Eigen::Array2d& total) {
        const Sides solid = meshes.solid(t);
        if (solid.isDegenerate())
          return;
        const Sides flat = meshes.flat(t);
        const LinearMap map(solid, flat);
        const double weight = solid.twice_area / sums.in_space;
        const double area = meshes.areaOnSphere(t, flat) / sums.covered / weight;
        // Written so that 0 / 0, which is not a number, counts as unbounded.
        angles[t] = {bounded(map.sigma_1 * map.sigma_1 / map.determinant), weight};
        areas[t] = {area >= 1.0 ? bounded(area) : bounded(1.0 / area), weight};
        // The map from the sphere has the singular values 1 / sigma_2 and 1 / sigma_1.
        const double sigma_2 = map.determinant / map.sigma_1;
        const double stretch = 0.5 *
                               (1.0 / (sigma_2 * sigma_2) + 1.0 / (map.sigma_1 * map.sigma_1)) *
                               (sums.on_sphere / sums.in_space);
        total += Eigen::Array2d((solid.angles() - flat.angles()).cwiseAbs().sum(),
                                weight * bounded(stretch));
      });
  for (internal::Indexed<Weighted>* values : {&angles, &areas})
    values->erase(std::remove(values->begin(), values->end(), none), values->end());
  return {std::move(angles), std::move(areas), totals[0], totals[1]};
}

}  // namespace

MapDistortion measureMapDistortion(const Positions& points, const Triangles& triangles,
                                   const Positions& sphere, int threads) {
  internal::checkThreads(threads);
  checkPositions(points, triangles, sphere);
  MapDistortion distortion;
  threads = internal::threadCount(threads, internal::columnCount(triangles));
  if (triangles.cols() == 0)
    return distortion;
  const double extent = points.cwiseAbs().maxCoeff();
  const Meshes meshes{points, sphere, triangles, extent > 0.0 ? 1.0 / extent : 1.0, threads};
  const Sums sums = sumsOf(meshes);
  distortion.flipped_triangles = sums.flipped;
  distortion.degenerate_triangles = sums.degenerate;
  Distortions distortions = distortionsOf(meshes, sums);
  const auto counted = static_cast<double>(distortions.angles.size());
  if (counted == 0.0)
    return distortion;
  constexpr double degrees = 57.29577951308232;
  distortion.mean_angle_difference = distortions.angle_difference * degrees / (3.0 * counted);
  // Area(M) / (4 pi) / L2(M)^2 with Sander et al.'s L2(M), their equation 3, which weights with the
  // areas in space.
  distortion.stretch_efficiency = std::min(1.0, 1.0 / distortions.squared_stretch);
  distortion.angle = statisticsOf(distortions.angles);
  distortion.area = statisticsOf(distortions.areas);
  return distortion;
}

}  // namespace spherical_param
