#include "scan_distances.h"

#include "parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherical_param::tools {

using Eigen::Vector3d;

Distance ball(const Vector3d& center, double radius) {
  return [=](const Vector3d& p) { return (p - center).norm() - radius; };
}

// The union of spheres along the axis. The one nearest to p has its centre before the foot of p, by
// `shift` times the distance of p from the axis.
Distance cone(const Vector3d& a, double radius_a, const Vector3d& b, double radius_b) {
  const double length = (b - a).norm();
  const double slope = (radius_a - radius_b) / length;
  const double shift = slope / std::sqrt(1.0 - slope * slope);
  return [=, axis = Vector3d((b - a) / length)](const Vector3d& p) {
    const Vector3d offset = p - a;
    const double along = offset.dot(axis);
    const double across = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along));
    const double s = std::clamp(along - across * shift, 0.0, length);
    return (offset - s * axis).norm() - (radius_a - s * slope);
  };
}

Distance arc(const Vector3d& center, const Vector3d& middle, const Vector3d& side, double radius,
             double tube, double reach) {
  return [=, x = middle.normalized().eval(), y = side.normalized().eval()](const Vector3d& p) {
    const Vector3d offset = p - center;
    const double angle = std::clamp(std::atan2(offset.dot(y), offset.dot(x)), -reach, reach);
    return (offset - radius * (std::cos(angle) * x + std::sin(angle) * y)).norm() - tube;
  };
}

// First order estimate of the distance, k0 (k0 - 1) / k1 with k0 = |x / r| and k1 = |x / r^2|
// (Quilez, "Ellipsoid - SDF", iquilezles.org/articles/ellipsoids).
Distance ellipsoid(const Vector3d& center, const Vector3d& radii, const Vector3d& forward) {
  Eigen::Matrix3d axes;
  axes << forward.normalized(), Vector3d::UnitY(), forward.normalized().cross(Vector3d::UnitY());
  return [=](const Vector3d& p) {
    const Vector3d x = (axes.transpose() * (p - center)).cwiseQuotient(radii);
    const double k0 = x.norm();
    const double k1 = x.cwiseQuotient(radii).norm();
    return k1 > 0.0 ? k0 * (k0 - 1.0) / k1 : -radii.minCoeff();
  };
}

Distance box(const Vector3d& center, const Vector3d& half_size, double rounding) {
  return [=](const Vector3d& p) {
    const Vector3d outside = ((p - center).cwiseAbs() - half_size).array() + rounding;
    return outside.cwiseMax(0.0).norm() + std::min(0.0, outside.maxCoeff()) - rounding;
  };
}

// The wave is 16 t^2 (1 - t)^2, t the fractional part of x.
Distance bumps(const Vector3d& center, double radius, double period, double amplitude) {
  // Orthogonal axes, none of them close to an axis of a shape's symmetry.
  Eigen::Matrix3d axes;
  axes << 2.0, 1.0, 2.0, -2.0, 2.0, 1.0, -1.0, -2.0, 2.0;
  return [=](const Vector3d& p) {
    const Vector3d offset = p - center;
    const double fade = std::max(0.0, 1.0 - offset.squaredNorm() / (radius * radius));
    const Eigen::Array3d x = axes * offset / (3.0 * period);
    const Eigen::Array3d t = x - x.floor();
    return amplitude * fade * fade * (16.0 * (t * (1.0 - t)).square()).prod();
  };
}

// The joint is the quadratic smooth minimum (Quilez, "Smooth minimum",
// iquilezles.org/articles/smin), which equals the minimum where the values differ by `blend`.
Distance body(const std::vector<Part>& middle, const std::vector<Part>& sides) {
  return [=](const Vector3d& p) {
    double result = std::numeric_limits<double>::max();
    const auto join = [&](const std::vector<Part>& parts, const Vector3d& at) {
      for (const auto& [distance, blend, sign] : parts) {
        const double a = sign * result;
        const double b = distance(at);
        const double overlap = blend - std::abs(a - b);
        const double fillet = overlap > 0.0 ? 0.25 * overlap * overlap / blend : 0.0;
        result = sign * (std::min(a, b) - fillet);
      }
    };
    join(middle, p);
    join(sides, {p.x(), -p.y(), p.z()});
    join(sides, p);
    return result;
  };
}

Vector3d gradientAt(const Vector3d& p, const Distance& distance) {
  constexpr double step = 1e-7;  // errors of rounding and of curvature are below 1e-8
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d move = step * Vector3d::Unit(axis);
    gradient[axis] = (distance(p + move) - distance(p - move)) / (2.0 * step);
  }
  return gradient;
}

void forEach(std::size_t count, const std::function<void(std::size_t)>& work) {
  internal::forEachIndex(count, internal::threadCount(0, count), {},
                         [&](Index i) { work(static_cast<std::size_t>(i)); });
}

}  // namespace spherical_param::tools
