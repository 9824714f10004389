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
/// Plain arithmetic nearly always decides; where it cannot, integers do.
///
/// \param points    3 x n, finite.
/// \param triangles 3 x m, closed.
int volumeSign(const Positions& points, const Triangles& triangles);

/// Whether all points lie exactly in one plane (or line, or point); true for fewer than four.
/// Points that rounding moved off a plane are not coplanar.
///
/// \param points 3 x n, finite, of any magnitude.
/// \throw InvalidInput if there are at least four points and a coordinate is not finite.
/// Cost: O(n); some microseconds for each point of an oblique plane.
bool areCoplanar(const Positions& points);

/// Half a unit in the last place of 1.
constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

/// A bound far above what products lose by underflow.
constexpr double kUnderflow = 1e-300;

/// Sign of a value with an error; 0 if the error may exceed the value.
inline int certainSign(double value, double error) {
  return value > error ? 1 : value < -error ? -1 : 0;
}

/// Sign of the determinant | a, b, c | by plain arithmetic; 0 if rounding may change it.
///
/// \param relative_error of the determinant [permanent].
inline int plainSign(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                     double relative_error) {
  const double bc = b.x() * c.y();
  const double cb = c.x() * b.y();
  const double ca = c.x() * a.y();
  const double ac = a.x() * c.y();
  const double ab = a.x() * b.y();
  const double ba = b.x() * a.y();
  const double determinant = a.z() * (bc - cb) + b.z() * (ca - ac) + c.z() * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(a.z()) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(b.z()) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(c.z());
  const double reach = std::abs(a.z()) + std::abs(b.z()) + std::abs(c.z());
  return certainSign(determinant, relative_error * permanent + kUnderflow * (1.0 + reach));
}

/// Sign of the determinant | b - a, c - a | of points in the plane, exact for all finite doubles: 1
/// counter-clockwise, 0 collinear, -1 clockwise.
inline int orientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                         const Eigen::Vector2d& c) {
  // ccwerrboundA of Shewchuk, section 4.2.
  constexpr double error = (3.0 + 16.0 * kUnitRoundoff) * kUnitRoundoff;
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const int sign =
      certainSign(left - right, error * (std::abs(left) + std::abs(right)) + kUnderflow);
  return sign != 0 ? sign : exactOrientation2d(a, b, c);
}

/// Sign of the determinant | b - a, c - a, d - a |, exact for all finite doubles: 0 if the four
/// points lie in one plane.
inline int orientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  // o3derrboundA of Shewchuk, section 4.3.
  const int sign = plainSign(b - a, c - a, d - a, (7.0 + 56.0 * kUnitRoundoff) * kUnitRoundoff);
  return sign != 0 ? sign : exactOrientation3d(a, b, c, d);
}

/// 1 if d is inside the circle through a, b and c (counter-clockwise), 0 if it is on the circle, -1
/// outside; the other way round if a, b and c are clockwise. Exact unless products of four
/// coordinate differences leave the range of double.
inline int inCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  const auto lifted = [&](const Eigen::Vector2d& p) {  // to a paraboloid
    const double x = p.x() - d.x();
    const double y = p.y() - d.y();
    return Eigen::Vector3d(x, y, x * x + y * y);
  };
  // iccerrboundA of Shewchuk, section 4.4.
  const int sign =
      plainSign(lifted(a), lifted(b), lifted(c), (10.0 + 96.0 * kUnitRoundoff) * kUnitRoundoff);
  return sign != 0 ? sign : exactInCircle(a, b, c, d);
}

}  // namespace spherical_param::internal
