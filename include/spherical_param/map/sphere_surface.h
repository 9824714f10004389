#pragma once

#include "spherical_param/types.h"

#include <memory>
#include <vector>

namespace spherical_param {

/// \addtogroup sphere_map
/// @{

/// Where a direction meets a map to the sphere.
struct SphereLocation {
  Index triangle = 0;  ///< the triangle that contains the direction
  /// Barycentric coordinates in the flat triangle between its corners on the sphere: >= 0, sum 1.
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
};

/// A point of a surface.
struct SurfaceSample {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [unit of the input]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< unit vector, outward
  SphereLocation location;                             ///< where it is in the mesh
};

/// How a surface is continued between the vertices of its mesh.
enum class SurfaceFit {
  Linear,  ///< the triangles themselves; normals are interpolated from those of the vertices
  /// A quadric over the tangent plane of each vertex, fitted to its neighbours (after Zwicker et
  /// al. 2002, "Pointshop 3D", section 4), blended over each triangle; through all vertices. Flat
  /// where the quadrics do not fit, as at sharp edges.
  Smooth,
};

/// Parameters of SphereSurface.
struct SphereSurfaceOptions {
  SurfaceFit fit = SurfaceFit::Smooth;  ///< between the vertices
  int threads = 0;                      ///< 0: one for each processor; [0, 1024]
  Positions caps = {};                  ///< SphereMap::caps of a mesh with openings
};

/// Many points of a surface.
struct SurfaceSamples {
  Positions positions;                    ///< 3 x n [unit of the input]
  Positions normals;                      ///< 3 x n, unit vectors, outward
  std::vector<SphereLocation> locations;  ///< n
};

/// The surface of an object as a function on the sphere (Zwicker and Gotsman 2004, section 5):
/// every direction has a position and a normal; in openings of the mesh, those of a cap. Immutable:
/// many threads may use it.
class SphereSurface {
public:
  /// \param points    3 x v, finite; \param sphere 3 x v, unit vectors.
  /// \param triangles as computeSphereMap() takes them; none flipped on the sphere.
  /// \param options   fit, threads, caps
  /// \throw InvalidInput for an invalid mesh, or with a flipped triangle on the sphere.
  /// Cost: O(v log v).
  SphereSurface(const Positions& points, const Triangles& triangles, const Positions& sphere,
                const SphereSurfaceOptions& options = {});
  ~SphereSurface();
  /// Moves a surface. \param other is empty afterwards
  SphereSurface(SphereSurface&& other) noexcept;
  /// Moves a surface. \param other is empty afterwards \return this
  SphereSurface& operator=(SphereSurface&& other) noexcept;
  SphereSurface(const SphereSurface& other) = delete;
  SphereSurface& operator=(const SphereSurface& other) = delete;

  /// Vertices in space. \return as given, then those of the caps
  const Positions& points() const;
  /// Triangles. \return as given, then those of the caps
  const Triangles& triangles() const;
  /// Vertices on the sphere. \return as given, then those of the caps
  const Positions& sphere() const;
  /// Area of the mesh in space, without caps. \return [squared unit of the input]
  double area() const;
  /// Fraction of the sphere that the mesh covers. \return 1 for a closed one, (0, 1]
  double coverage() const;
  /// Whether the mesh has openings. \return true if it has
  bool isOpen() const;
  /// Whether a triangle belongs to a cap. \param triangle of triangles() \return true if it does
  bool isCap(Index triangle) const;

  /// The triangle that contains a direction; on an edge or at a corner one of the triangles that
  /// share it. O(log v), typically. \param direction of any length > 0; coordinates below 1e-100 of
  /// the largest count as 0. \return the triangle, and where in it. \throw InvalidInput for a
  /// direction that is zero or not finite.
  SphereLocation locate(const Eigen::Vector3d& direction) const;

  /// Position and normal at a direction.
  /// \param direction of any length > 0.
  /// \return the point of the surface.
  /// \throw as locate()
  SurfaceSample evaluate(const Eigen::Vector3d& direction) const;

  /// Position and normal at a known location, such as one of locate(), and any weights >= 0 with
  /// sum 1 in any triangle.
  /// \param location triangle and weights.
  /// \return the point of the surface.
  SurfaceSample evaluate(const SphereLocation& location) const;

  /// The same for many directions, on several threads.
  /// \param directions 3 x n, each of any length > 0.
  /// \return one point for each column.
  SurfaceSamples evaluate(const Positions& directions) const;

private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

/// @}

}  // namespace spherical_param
