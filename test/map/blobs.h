#pragma once

#include "map_shapes.h"

namespace spherical_param::test {

/// A sphere with bumps of different sizes at places without any symmetry.
struct Blob {
  std::vector<Vector3d> places;
  std::vector<double> heights;

  double radius(const Vector3d& u) const {
    double r = 1.0;
    for (std::size_t i = 0; i < places.size(); ++i)
      r += heights[i] * std::exp(-6.0 * (1.0 - u.dot(places[i].normalized())));
    return r;
  }
  Mapped over(const Positions& sphere) const {
    return mappedOver(sphere, [&](const Vector3d& u) { return Vector3d(radius(u) * u); });
  }
};

/// The vertex whose direction is nearest to one.
inline Index nearestTo(const Vector3d& direction, const Mapped& mesh) {
  Eigen::Index i = 0;
  (mesh.sphere.colwise() - direction.normalized()).colwise().norm().minCoeff(&i);
  return static_cast<Index>(i);
}

inline Blob firstBlob() {
  return {{{1, 0.1, 0.2}, {-0.3, 1, 0.1}, {0.4, -0.2, -1}}, {1.5, 0.9, 0.5}};
}

inline Blob secondBlob() {
  return {{{0.1, 1, -0.3}, {-1, 0.2, 0.3}, {0.1, 0.1, 1}, {0.8, -0.7, 0}}, {1.3, 1.0, 0.4, -0.3}};
}

}  // namespace spherical_param::test
