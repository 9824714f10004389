#pragma once

#include "open_places.h"
#include "optimization_constants.h"
#include "pi.h"
#include "spherical_param/types.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spherical_param::internal {

/// Data of a triangle for the energy.
struct Facet {
  Eigen::Vector3d normal;  ///< of unit length; 0 for a triangle without area
  double radius;           ///< min(R, 4 * longest side), with the circumradius R; half if open
  bool is_open;            ///< the triangle is over an opening of the surface

  /// Cosine of the angle between two normals; 1 at an open triangle, which does not bend.
  static double cosine(const Facet& a, const Facet& b) {
    return a.is_open || b.is_open ? 1.0 : a.normal.dot(b.normal);
  }
};

/// A facet before its normal is normalised: often only the radius is needed.
struct RawFacet {
  Eigen::Vector3d normal;
  double twice_area;
  double radius;
  bool is_open = false;

  RawFacet(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const Eigen::Vector3d ab = b - a;
    const Eigen::Vector3d ac = c - a;
    normal = ab.cross(ac);
    twice_area = normal.norm();
    const double ab2 = ab.squaredNorm();
    const double ac2 = ac.squaredNorm();
    const double bc2 = (c - b).squaredNorm();
    radius = 4.0 * std::sqrt(std::max({ab2, ac2, bc2}));
    if (twice_area > 0.0)
      radius = std::min(std::sqrt(ab2 * ac2 * bc2) / (2.0 * twice_area), radius);
  }

  /// Makes it an open triangle, at half of the cost.
  void open() {
    is_open = true;
    radius *= 0.5;
  }

  Facet facet() const {
    if (!(twice_area > 0.0))
      return {Eigen::Vector3d::Zero(), radius, is_open};
    return {normal / twice_area, radius, is_open};
  }
};

/// acos(x) for x in [-1, 1] within 3e-8 (Abramowitz and Stegun 1964, equation 4.4.46): several
/// times faster, and the same bits on every platform.
inline double fastAcos(double x) {
  const double y = std::abs(x);
  const double polynomial =
      1.5707963050 +
      y * (-0.2145988016 +
           y * (0.0889789874 +
                y * (-0.0501743046 +
                     y * (0.0308918810 +
                          y * (-0.0170881256 + y * (0.0066700901 - y * 0.0012624911))))));
  const double angle = std::sqrt(std::max(0.0, 1.0 - y)) * polynomial;
  return x < 0.0 ? kPi - angle : angle;
}

/// Energy of a triangle mesh on points: the sum over its edges of length * bend, and over its
/// triangles of mu * min(R, 4 * longest side), with the circumradius R. No term is negative.
///
/// A triangle over an opening costs half and does not bend; its edges have a price, except those in
/// the loop around the opening.
struct SurfaceEnergy {
  /// Cost of an edge by the angle between the normals of its triangles [rad].
  enum class Bend {
    Angle,   ///< the angle: together, the total absolute mean curvature
    Power,   ///< angle^1.5
    Excess,  ///< the excess over 10 degrees
  };

  Bend bend = Bend::Angle;
  double mu = optimization_constants::kMu;
  /// The openings of the surface, if any; must outlive this.
  const OpenPlaces* openings = nullptr;

  /// Cost of a triangle.
  double cost(double radius) const { return mu * radius; }

  /// Cost of the edge from vertex v at p to vertex w at q, with its triangles.
  double edge(Index v, Index w, const Eigen::Vector3d& p, const Eigen::Vector3d& q,
              const Facet& facet, const Facet& other) const {
    if (facet.is_open || other.is_open)
      return openEdge(v, w, p, q, facet.is_open && other.is_open);
    const double length = (p - q).norm();
    const double angle = fastAcos(facet.normal.dot(other.normal));
    if (bend == Bend::Angle)
      return length * angle;
    if (bend == Bend::Power)
      return length * angle * std::sqrt(angle);
    return length * std::max(0.0, angle - kPi / 18.0);
  }

private:
  /// Cost of an edge of an open triangle: too low makes holes, too high folds ears. Between two
  /// open triangles it is half of that; else open clouds of several views keep self-intersections.
  double openEdge(Index v, Index w, const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                  bool are_both_open) const {
    if (openings->isBoundary(v, w))
      return 0.0;
    const double price = (0.8 + 2.0 * mu) * (p - q).norm();
    return are_both_open ? 0.5 * price : price;
  }
};

}  // namespace spherical_param::internal
