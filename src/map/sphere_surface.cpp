#include "spherical_param/map/sphere_surface.h"

#include "caps.h"
#include "corner_table.h"
#include "index_loops.h"
#include "input_checks.h"
#include "pi.h"
#include "sphere_locator.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "triangle_geometry.h"
#include "vertex_quadrics.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

using internal::kPi;

/// The solid angle of a triangle on the unit sphere (A. van Oosterom and J. Strackee, 1983).
double solidAngle(const Positions& sphere, const Triangles& triangles, Eigen::Index t) {
  const Vector3d a = sphere.col(triangles(0, t));
  const Vector3d b = sphere.col(triangles(1, t));
  const Vector3d c = sphere.col(triangles(2, t));
  return 2.0 * std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

void checkInput(const Positions& points, const Triangles& triangles, const Positions& sphere,
                int threads) {
  if (points.cols() != sphere.cols())
    throw InvalidInput("SphereSurface: " + std::to_string(points.cols()) + " points, but " +
                       std::to_string(sphere.cols()) + " on the sphere; they must be the same");
  internal::checkTriangles("SphereSurface", triangles, points.cols());
  if (!points.allFinite())
    throw InvalidInput("SphereSurface: a coordinate of a point is not finite; leave such points "
                       "out before the mesh is made");
  internal::checkUnitVectors("SphereSurface", sphere, 1e-9);
  if (!checkTopology(triangles, internal::columnCount(points), threads).isSphere())
    throw InvalidInput("SphereSurface: the triangles must be a manifold, consistently oriented "
                       "mesh of genus 0 over all points, with the caps of SphereMap if it has "
                       "openings; see checkTopology()");

  const std::size_t count = internal::columnCount(triangles);
  struct Covering {
    double angle = 0.0;
    Index flipped = 0;
    Index first = 0;  ///< that is flipped, if one is
    Covering& operator+=(const Covering& other) {
      first = flipped > 0 ? first : other.first;
      angle += other.angle;
      flipped += other.flipped;
      return *this;
    }
  };
  const Covering sums = internal::sumOfIndices(count, threads, Covering(), [&](Index t) {
    if (internal::isFlipped(sphere, triangles, t))
      return Covering{0.0, 1, t};
    return Covering{solidAngle(sphere, triangles, t), 0, 0};
  });
  if (sums.flipped > 0)
    throw InvalidInput("SphereSurface: triangle " + std::to_string(sums.first) +
                       " is flipped on the sphere or has no area there, as " +
                       std::to_string(sums.flipped) + " of " + std::to_string(count) +
                       " are; make a map that is one to one by computeSphereMap()");
  // Without a flip the map may still wind round some vertices more than once.
  if (sums.angle > 6.0 * kPi)
    throw InvalidInput("SphereSurface: the triangles cover the sphere " +
                       std::to_string(std::lround(sums.angle / (4.0 * kPi))) +
                       " times; make a map that is one to one by computeSphereMap()");
}

double areaOf(const Positions& points, const Triangles& triangles, int threads) {
  return internal::sumOfIndices(internal::columnCount(triangles), threads, 0.0, [&](Index t) {
    return 0.5 * internal::areaNormal(points, triangles, t).norm();
  });
}

}  // namespace

struct SphereSurface::Data {
  /// \param mesh_triangles of the triangles are those of the mesh, the others those of caps.
  Data(Positions points_in, Triangles triangles_in, Positions sphere_in,
       Eigen::Index mesh_triangles_in, const SphereSurfaceOptions& options)
      : thread_limit(options.threads), points(std::move(points_in)),
        triangles(std::move(triangles_in)), sphere(std::move(sphere_in)),
        mesh_triangles(mesh_triangles_in),
        area(areaOf(points, triangles.leftCols(mesh_triangles), thread_limit)),
        locator(sphere, triangles, thread_limit) {
    const std::size_t count = internal::columnCount(points);
    const int threads = internal::threadCount(thread_limit, count);
    // Caps do not shape the surface at their loops.
    const internal::CornerTable corners(triangles.leftCols(mesh_triangles), count, threads);
    normals = internal::vertexNormals(points, triangles, sphere, corners, thread_limit);
    if (options.fit == SurfaceFit::Smooth)
      quadrics.emplace(points, triangles, normals, corners, thread_limit);
  }

  SphereLocation locate(const Vector3d& direction) const {
    SphereLocation location = locator.locate(direction);
    if (location.triangle < 0)
      throw ComputeError(
          "SphereSurface: no triangle holds a direction, as coordinates on the sphere are too "
          "small for exact signs; turn the sphere a little");
    return location;
  }

  /// \param location with a triangle of the mesh.
  SurfaceSample at(const SphereLocation& location) const {
    SurfaceSample sample;
    sample.location = location;
    if (quadrics) {
      const internal::VertexQuadrics::Point point =
          quadrics->at(location.triangle, location.weights);
      sample.position = point.position;
      sample.normal = unitNormal(point.normal, location);
      return sample;
    }
    const auto blend = [&](const Positions& columns) {
      return internal::blend(columns, triangles, location.triangle, location.weights);
    };
    sample.position = blend(points);
    sample.normal = unitNormal(blend(normals), location);
    return sample;
  }

  /// A normal of unit length, also where those of the corners cancel.
  Vector3d unitNormal(const Vector3d& normal, const SphereLocation& location) const {
    constexpr double least = 1e-6;
    const double length = normal.norm();
    if (length > least)
      return normal / length;
    Eigen::Index nearest = 0;
    location.weights.maxCoeff(&nearest);
    return normals.col(triangles(nearest, location.triangle));
  }

  int thread_limit;  ///< SphereSurfaceOptions::threads
  Positions points;
  Triangles triangles;
  Positions sphere;
  Eigen::Index mesh_triangles;
  Positions normals;  ///< of the vertices
  double area;
  internal::SphereLocator locator;
  std::optional<internal::VertexQuadrics> quadrics;  ///< for SurfaceFit::Smooth
};

SphereSurface::SphereSurface(const Positions& points, const Triangles& triangles,
                             const Positions& sphere, const SphereSurfaceOptions& options) {
  internal::checkEnum("SphereSurface: fit", options.fit, SurfaceFit::Smooth);
  if (options.caps.cols() == 0) {
    checkInput(points, triangles, sphere, options.threads);
    data_ = std::make_unique<const Data>(points, triangles, sphere, triangles.cols(), options);
    return;
  }
  internal::checkTriangles("SphereSurface", triangles, points.cols());
  if (!checkTopology(triangles, internal::columnCount(points), options.threads).isOpenSurface())
    throw InvalidInput("SphereSurface: there are caps, but the triangles are not a consistently "
                       "oriented manifold with boundary over all points; give the mesh of the map");
  internal::CappedMesh capped = internal::capOpenings(points, triangles);
  Positions all(3, sphere.cols() + options.caps.cols());
  all << sphere, options.caps;
  checkInput(capped.points, capped.triangles, all, options.threads);
  data_ = std::make_unique<const Data>(std::move(capped.points), std::move(capped.triangles),
                                       std::move(all), triangles.cols(), options);
}

SphereSurface::~SphereSurface() = default;
SphereSurface::SphereSurface(SphereSurface&& other) noexcept = default;
SphereSurface& SphereSurface::operator=(SphereSurface&& other) noexcept = default;

const Positions& SphereSurface::points() const {
  return data_->points;
}

const Triangles& SphereSurface::triangles() const {
  return data_->triangles;
}

const Positions& SphereSurface::sphere() const {
  return data_->sphere;
}

double SphereSurface::area() const {
  return data_->area;
}

double SphereSurface::coverage() const {
  double openings = 0.0;
  for (Eigen::Index t = data_->mesh_triangles; t < data_->triangles.cols(); ++t)
    openings += solidAngle(data_->sphere, data_->triangles, t);
  // More than 0 also where rounding loses the mesh's part of the sphere.
  constexpr double least = 1e-12;
  return std::max(least, 1.0 - openings / (4.0 * kPi));
}

bool SphereSurface::isOpen() const {
  return data_->mesh_triangles < data_->triangles.cols();
}

bool SphereSurface::isCap(Index triangle) const {
  return triangle >= data_->mesh_triangles;
}

SphereLocation SphereSurface::locate(const Vector3d& direction) const {
  internal::checkDirections("SphereSurface", direction);
  return data_->locate(direction);
}

SurfaceSample SphereSurface::evaluate(const Vector3d& direction) const {
  return data_->at(locate(direction));
}

SurfaceSample SphereSurface::evaluate(const SphereLocation& location) const {
  if (location.triangle < 0 || location.triangle >= data_->triangles.cols())
    throw InvalidInput("SphereSurface: location in triangle " + std::to_string(location.triangle) +
                       " of " + std::to_string(data_->triangles.cols()) +
                       "; use one of locate() of this surface");
  return data_->at(location);
}

SurfaceSamples SphereSurface::evaluate(const Positions& directions) const {
  internal::checkDirections("SphereSurface", directions);
  SurfaceSamples samples;
  samples.positions.resize(3, directions.cols());
  samples.normals.resize(3, directions.cols());
  samples.locations.resize(internal::columnCount(directions));
  internal::forEachIndex(samples.locations.size(), data_->thread_limit, [&](Index i) {
    const SurfaceSample sample = data_->at(data_->locate(directions.col(i)));
    samples.positions.col(i) = sample.position;
    samples.normals.col(i) = sample.normal;
    internal::entry(samples.locations, i) = sample.location;
  });
  return samples;
}

}  // namespace spherical_param
