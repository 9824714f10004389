#include "point_set.h"

#include "exact_predicates.h"
#include "spherical_param/errors.h"

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
  // The first points that span a line and a plane, if any do.
  const Eigen::Vector3d a = points.col(0);
  Eigen::Index i = 1;
  while (i < n && points.col(i) == a)
    ++i;
  const Eigen::Vector3d b = points.col(i % n);
  while (i < n && areCollinear(a, b, points.col(i)))
    ++i;
  const Eigen::Vector3d c = points.col(i % n);
  for (; i < n; ++i)
    if (internal::orientation3d(a, b, c, points.col(i)) != 0)
      return false;
  return true;
}

}  // namespace spherical_param
