#pragma once

#include "caps.h"
#include "exact_predicates.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>

#include <cstdlib>
#include <iterator>
#include <limits>
#include <set>
#include <string>

/// Meshes with a map to the sphere that the tests of the map share.
namespace spherical_param::test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Mapped {
  Positions points;
  Triangles triangles;
  Positions sphere;

  Positions caps = {};

  SphereSurface surface(SurfaceFit fit = SurfaceFit::Linear, int threads = 0) const {
    return {points, triangles, sphere, {fit, threads, caps}};
  }
};

/// The shape that place() makes of directions.
template <typename Place>
Mapped mappedOver(const Positions& sphere, const Place& place) {
  Mapped mesh{sphere, triangulateSphere(sphere), sphere};
  for (Eigen::Index i = 0; i < sphere.cols(); ++i)
    mesh.points.col(i) = place(Vector3d(sphere.col(i)));
  return mesh;
}

template <typename Place>
SphereSurface surfaceOver(Index n, const Place& place, int threads = 0) {
  return mappedOver(spiralSphere(n), place).surface(SurfaceFit::Linear, threads);
}

/// Directions as their own mesh.
inline Mapped mapped(const Positions& sphere) {
  return mappedOver(sphere, [](const Vector3d& u) { return u; });
}

/// A bumpy shape over directions.
inline Mapped bumpy(const Positions& sphere) {
  return mappedOver(sphere, [](const Vector3d& u) {
    return Vector3d((2.0 + 0.3 * std::sin(3.0 * u.x()) * std::cos(2.0 * u.y())) * u);
  });
}

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

/// A mesh without the triangles that have a corner within some distance of a center on the sphere,
/// mapped by computeSphereMap().
inline Mapped withOpenings(const Mapped& mesh, const Positions& centers, double radius) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corners = mesh.triangles.col(t);
    if (std::all_of(corners.begin(), corners.end(), [&](Index v) {
          return (centers.colwise() - mesh.sphere.col(v)).colwise().norm().minCoeff() > radius;
        }))
      kept.push_back(t);
  }
  Triangles triangles = mesh.triangles(Eigen::all, kept);
  const std::vector<Index> used = internal::compact(triangles, mesh.points.cols());
  Mapped open{mesh.points(Eigen::all, used), triangles, mesh.sphere(Eigen::all, used)};
  const SphereMap map = computeSphereMap(open.points, open.triangles, open.sphere);
  open.sphere = map.sphere;
  open.caps = map.caps;
  return open;
}

/// A bumpy shape of about n vertices with three openings.
inline Mapped openBumpy(Index n) {
  return withOpenings(bumpy(spiralSphere(n)), spiralSphere(3), 0.4);
}

/// The 4 f^2 + 2 grid points on an octahedron whose edges have f parts: vertices and edges on the
/// planes of coordinates.
inline Mapped octasphere(int parts) {
  Positions sphere(3, 4 * parts * parts + 2);
  Eigen::Index i = 0;
  for (int x = -parts; x <= parts; ++x)
    for (int y = -parts; y <= parts; ++y)
      for (int z = -parts; z <= parts; ++z)
        if (std::abs(x) + std::abs(y) + std::abs(z) == parts)
          sphere.col(i++) = Vector3d(x, y, z).normalized();
  return mapped(sphere);
}

/// Two apices and a ring of so many vertices between them.
inline Mapped doubleCone(Index ring) {
  const auto place = [=](Index i) { return onCircle(2.0 * kPi * i / ring); };
  return mapped(horizontally(pointsAt(ring, place), Vector3d::UnitZ(), -Vector3d::UnitZ()));
}

inline Positions regularTetrahedron() {
  Positions corners(3, 4);
  corners << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  return corners / std::sqrt(3.0);
}

/// Without any order: triangles of all shapes and sizes that intersect each other.
inline Positions randomPositions(Eigen::Index n, std::uint64_t seed) {
  return withNoise(Positions::Zero(3, n), 1.0, seed);
}

inline Matrix3d rotationBy(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// A linear map of directions keeps the orientation of all triangles.
inline Mapped transformed(Mapped mesh, const Matrix3d& matrix) {
  mesh.sphere = (matrix * mesh.sphere).colwise().normalized();
  return mesh;
}

/// Those of the grid points on a cube.
inline Positions cubeDirections(int m) {
  return (cubeGrid(m).array() - 0.5).matrix().colwise().normalized();
}

/// Area of the unit sphere that a triangle covers, by its angles (A. Girard, 1629).
inline double sphericalArea(const Positions& sphere, const Triangles& triangles, Eigen::Index t) {
  double sum = -kPi;
  for (int k = 0; k < 3; ++k) {
    const Vector3d a = sphere.col(triangles(k, t));
    const Vector3d b = sphere.col(triangles((k + 1) % 3, t));
    const Vector3d c = sphere.col(triangles((k + 2) % 3, t));
    sum += std::atan2(std::abs(a.dot(b.cross(c))), a.cross(b).dot(a.cross(c)));
  }
  return sum;
}

/// Of the call: empty, or the message of InvalidInput.
inline std::string refusalOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// Whether directions are unit vectors, no triangle is flipped, and all cover the sphere once.
inline bool isOneToOne(const Positions& sphere, const Triangles& triangles) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    if (internal::orientation3d(Vector3d::Zero(), sphere.col(triangles(0, t)),
                                sphere.col(triangles(1, t)), sphere.col(triangles(2, t))) <= 0)
      return false;
    area += sphericalArea(sphere, triangles, t);
  }
  return (sphere.colwise().norm().array() - 1.0).abs().maxCoeff() < 1e-14 &&
         std::abs(area - 4.0 * kPi) < 1e-6;
}

}  // namespace spherical_param::test
