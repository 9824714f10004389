#pragma once

#include "common/cloud_reconstruction.h"
#include "common/point_data.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {

/// A mesh as a report shows it, in an order in which neighbours are near each other.
struct ReportMesh {
  Positions positions;  ///< 3 x v [unit of the input]
  Positions sphere;     ///< 3 x v, unit vectors
  Triangles triangles;  ///< 3 x t
  /// v entries each: log2 of the share of the sphere around a vertex over that of the surface;
  /// sigma_1 / sigma_2 of the map, mean; log10 of the tangential Laplacian [radius].
  std::vector<double> area_distortion;
  std::vector<double> angle_distortion;
  std::vector<double> residual;
  std::vector<Color> colors;        ///< v, or none
  std::vector<std::uint8_t> marks;  ///< t entries, bits of TriangleMarks
  bool decimated = false;           ///< fewer vertices than the mesh has
};

/// What ReportMesh::residual holds for a vertex: log10, never less than -17. What is not finite
/// counts as 0.
double residualExponent(double residual);

/// The numbering of a mesh in which differences between one vertex or triangle and the next are
/// small: breadth first, around each vertex in turn.
struct MeshOrder {
  std::vector<Index> vertices;   ///< old number of each new vertex
  std::vector<Index> triangles;  ///< old number of each new triangle
  Triangles renumbered;          ///< the new triangles, the least vertex first
};

/// \param triangles manifold, over some of the vertices 0 ... vertex_count - 1.
MeshOrder traversalOrder(const Triangles& triangles, std::size_t vertex_count);

/// Some of many points, spread evenly over space, ascending; the same on every platform.
///
/// \param points 3 x n, finite.
/// \param kept   n entries, true: to be among them, if there is room.
/// \param count  at most so many; more than 80 % of it where there are as many places.
std::vector<Index> evenSubset(const Positions& points, const std::vector<bool>& kept,
                              std::size_t count);

/// The mesh of a result that was made with Options::details, of at most so many triangles: of a
/// larger one a subset of its vertices is triangulated on the sphere.
ReportMesh reportMesh(const CloudReconstruction& cloud, std::size_t most_triangles, int threads);

}  // namespace spherical_param::tools
