#include "point_set.h"

#include "exact_predicates.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <cmath>

namespace spherical_param {
namespace {

/// Whether products of three differences of such coordinates, and their rounding errors, are
/// numbers of full precision.
bool areProductsInRange(const Positions& points) {
  constexpr double least = 1e-80;
  constexpr double largest = 1e80;
  return points
             .unaryExpr([](double x) {
               return x == 0.0 || (std::abs(x) >= least && std::abs(x) <= largest) ? 1.0 : 0.0;
             })
             .minCoeff() > 0.0;
}

/// The predicates for points of which is known whether products are in range.
class Orientations {
public:
  explicit Orientations(bool are_products_in_range) : is_plain_(are_products_in_range) {}

  bool areCoplanar(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const Eigen::Vector3d& d) const {
    return (is_plain_ ? internal::orientation3d(a, b, c, d)
                      : internal::anyRangeOrientation3d(a, b, c, d)) == 0;
  }
  bool areCollinear(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                    const Eigen::Vector3d& c) const {
    return areCollinearInPlane(a.head<2>(), b.head<2>(), c.head<2>()) &&
           areCollinearInPlane(a.tail<2>(), b.tail<2>(), c.tail<2>()) &&
           areCollinearInPlane(Eigen::Vector2d(a.x(), a.z()), Eigen::Vector2d(b.x(), b.z()),
                               Eigen::Vector2d(c.x(), c.z()));
  }

private:
  bool areCollinearInPlane(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                           const Eigen::Vector2d& c) const {
    return (is_plain_ ? internal::orientation2d(a, b, c)
                      : internal::anyRangeOrientation2d(a, b, c)) == 0;
  }

  bool is_plain_;
};

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
  const Orientations orientations(areProductsInRange(points));
  if (orientations.areCollinear(a, b, points.col(third))) {
    // Rounding may have hidden a point beside the line.
    third = 0;
    while (third < n && orientations.areCollinear(a, b, points.col(third)))
      ++third;
    if (third == n)
      return true;
  }
  const Eigen::Vector3d c = points.col(third);
  for (Eigen::Index i = 0; i < n; ++i)
    if (!orientations.areCoplanar(a, b, c, points.col(i)))
      return false;
  return true;
}

}  // namespace spherical_param
