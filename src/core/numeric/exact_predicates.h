#pragma once

#include "spherical_param/types.h"

#include <Eigen/Core>

#include <cmath>
#include <limits>

// Exact in integers, behind the filters of J. R. Shewchuk: "Adaptive Precision Floating-Point
// Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997.
// Valid for round-to-nearest and without contraction of a * b + c.

namespace spherical_param::internal {

/// The predicates without the filter, in integers. \see orientation2d, orientation3d, inCircle
int exactOrientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c);
int exactOrientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d);
int exactInCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d);

/// The sign of the volume that a closed mesh encloses, exact: 1 if its triangles face outward.
/// Plain arithmetic decides nearly always, else integers.
///
/// \param points    3 x n, finite.
/// \param triangles 3 x m, closed.
int volumeSign(const Positions& points, const Triangles& triangles);

/// Half a unit in the last place of 1.
constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

/// Far more than what is lost where products underflow.
constexpr double kUnderflow = 1e-300;

/// Sign of the determinant | b - a, c - a | of points in the plane, exact for all finite doubles: 1
/// counter-clockwise, 0 collinear, -1 clockwise.
inline int orientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                         const Eigen::Vector2d& c) {
  // Bound of the error of the plain evaluation relative to the permanent: ccwerrboundA of
  // Shewchuk, section 4.2.
  constexpr double filter = (3.0 + 16.0 * kUnitRoundoff) * kUnitRoundoff;
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  const double bound = filter * (std::abs(left) + std::abs(right)) + kUnderflow;
  if (determinant > bound)
    return 1;
  if (-determinant > bound)
    return -1;
  return exactOrientation2d(a, b, c);
}

/// Sign of the determinant | b - a, c - a, d - a |, exact for all finite doubles: 0 if the four
/// points lie in one plane.
inline int orientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  // Bound of the error of the plain evaluation relative to the permanent: o3derrboundA of
  // Shewchuk, section 4.3.
  constexpr double filter = (7.0 + 56.0 * kUnitRoundoff) * kUnitRoundoff;
  const Eigen::Vector3d ad = b - a;
  const Eigen::Vector3d bd = c - a;
  const Eigen::Vector3d cd = d - a;
  const double bc = bd.x() * cd.y();
  const double cb = cd.x() * bd.y();
  const double ca = cd.x() * ad.y();
  const double ac = ad.x() * cd.y();
  const double ab = ad.x() * bd.y();
  const double ba = bd.x() * ad.y();
  const double determinant = ad.z() * (bc - cb) + bd.z() * (ca - ac) + cd.z() * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(ad.z()) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(bd.z()) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cd.z());
  const double reach = std::abs(ad.z()) + std::abs(bd.z()) + std::abs(cd.z());
  const double bound = filter * permanent + kUnderflow * (1.0 + reach);
  if (determinant > bound)
    return 1;
  if (-determinant > bound)
    return -1;
  return exactOrientation3d(a, b, c, d);
}

/// 1 if d is inside the circle through a, b and c (counter-clockwise), 0 if it is on the circle, -1
/// outside; the other way round if a, b and c are clockwise. Exact unless products of four
/// coordinate differences leave the range of double.
inline int inCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  // Bound of the error of the plain evaluation relative to the permanent: iccerrboundA of
  // Shewchuk, section 4.4.
  constexpr double filter = (10.0 + 96.0 * kUnitRoundoff) * kUnitRoundoff;
  const double adx = a.x() - d.x();
  const double ady = a.y() - d.y();
  const double bdx = b.x() - d.x();
  const double bdy = b.y() - d.y();
  const double cdx = c.x() - d.x();
  const double cdy = c.y() - d.y();
  const double bc = bdx * cdy;
  const double cb = cdx * bdy;
  const double ca = cdx * ady;
  const double ac = adx * cdy;
  const double ab = adx * bdy;
  const double ba = bdx * ady;
  const double a_lift = adx * adx + ady * ady;
  const double b_lift = bdx * bdx + bdy * bdy;
  const double c_lift = cdx * cdx + cdy * cdy;
  const double determinant = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * a_lift +
                           (std::abs(ca) + std::abs(ac)) * b_lift +
                           (std::abs(ab) + std::abs(ba)) * c_lift;
  const double bound = filter * permanent;
  if (determinant > bound)
    return 1;
  if (-determinant > bound)
    return -1;
  return bound == 0.0 ? 0 : exactInCircle(a, b, c, d);
}

}  // namespace spherical_param::internal
