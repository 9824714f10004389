#include "point_set.h"

#include "exact_predicates.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

namespace spherical_param {
namespace {

bool areCollinear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto flat = [&](const Eigen::Vector3d& p) {
      return Eigen::Vector2d(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    };
    if (internal::orientation2d(flat(a), flat(b), flat(c)) != 0)
      return false;
  }
  return true;
}

}  // namespace

bool areCoplanar(const Positions& points) {
  const Eigen::Index n = points.cols();
  if (n < 4)
    return true;
  if (!points.allFinite())
    throw InvalidInput("areCoplanar: a coordinate is not finite; remove such points first");
  // A far-apart triangle makes the plain evaluation of the predicate decide nearly always.
  const Eigen::Vector3d a = points.col(0);
  Eigen::Index second = 0;
  (points.colwise() - a).cwiseAbs().colwise().maxCoeff().maxCoeff(&second);
  const Eigen::Vector3d b = points.col(second);
  Eigen::Index third = 0;
  double largest = -1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double area = (b - a).cross(points.col(i) - a).cwiseAbs().maxCoeff();
    if (area > largest) {
      largest = area;
      third = i;
    }
  }
  if (areCollinear(a, b, points.col(third))) {
    // Rounding may have hidden a point beside the line.
    third = 0;
    while (third < n && areCollinear(a, b, points.col(third)))
      ++third;
    if (third == n)
      return true;
  }
  const Eigen::Vector3d c = points.col(third);
  for (Eigen::Index i = 0; i < n; ++i)
    if (internal::orientation3d(a, b, c, points.col(i)) != 0)
      return false;
  return true;
}

}  // namespace spherical_param
