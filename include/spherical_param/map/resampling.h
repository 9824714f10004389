#pragma once

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup resampling
/// @{

/// Regular triangulations of the unit sphere.
enum class SphereGrid {
  Icosahedral,  ///< geodesic: each face of an icosahedron in f^2 triangles; 10 f^2 + 2 vertices
  Octahedral,   ///< each face of an octahedron in f^2 triangles; 4 f^2 + 2 vertices
};

/// A triangulated unit sphere.
struct GridSphere {
  Positions directions;  ///< 3 x v, unit vectors
  Triangles triangles;   ///< 3 x (2v - 4), outward
  int frequency = 0;     ///< f: parts of each edge of the solid
};

/// The frequency that comes nearest to a number of vertices.
///
/// \param grid     the kind of grid.
/// \param vertices the number.
/// \return the frequency, at least 1.
int gridFrequency(SphereGrid grid, std::size_t vertices);

/// The frequency of a grid that comes nearest to a number of vertices on a surface: those in its
/// openings do not count.
///
/// \param grid     the kind of grid.
/// \param vertices the number.
/// \param surface  that is sampled.
/// \return the frequency, at least 1.
int gridFrequency(SphereGrid grid, std::size_t vertices, const SphereSurface& surface);

/// Vertices of a grid.
///
/// \param grid      the kind of grid.
/// \param frequency parts of each edge of the solid.
/// \return their number.
/// \throw InvalidInput for a frequency below 1 or more than 2^29 vertices.
std::size_t gridVertices(SphereGrid grid, int frequency);

/// A regular triangulation of the sphere.
///
/// \param grid the kind of grid.
/// \param frequency parts of each edge of the solid.
/// \return the sphere.
/// \throw InvalidInput for a frequency below 1 or more than 2^29 vertices.
GridSphere makeGridSphere(SphereGrid grid, int frequency);

/// A mesh, with the directions that its vertices come from.
struct ResampledMesh {
  Positions points;      ///< 3 x v [unit of the input]
  Positions normals;     ///< 3 x v, unit vectors, outward
  Positions directions;  ///< 3 x v, unit vectors: the map to the sphere goes with it
  Triangles triangles;   ///< 3 x (2v - 4), outward
};

/// Parameters of a map that a surface is sampled by: it keeps angles more than the default, as long
/// thin triangles cut across folds of the surface.
///
/// \return area_weight 0.5, 40 sweeps; the rest by default.
SphereMapOptions mapOptionsForResampling();

/// The surface at the vertices of a triangulated sphere: manifold, genus 0, and a map to the sphere
/// that is one to one.
///
/// Openings of the surface stay open: vertices of the grid next to a boundary move to it, and the
/// others in openings are dropped.
///
/// \param surface with its map.
/// \param grid    that of makeGridSphere(), or any other.
/// \return the mesh, with the triangles of the grid; of a closed surface with all of them.
ResampledMesh resampleSurface(const SphereSurface& surface, const GridSphere& grid);

/// Report of untangle().
struct UntanglingReport {
  std::size_t before = 0;  ///< pairs of triangles that intersected
  std::size_t after = 0;   ///< pairs that still do
  int rounds = 0;          ///< number of rounds
  Index moved = 0;         ///< number of moved vertices
  std::size_t flips = 0;   ///< number of flipped edges
};

/// Slides vertices along the surface until triangles do not intersect: long thin triangles cut
/// across its folds. Vertices away from intersections and on a boundary stay.
///
/// Where a map is stretched, the edges of a grid may run across a valley of the surface instead of
/// along it, and its triangles fold. So edges around what sliding leaves are flipped, if the
/// opposite angles become smaller in space (C. L. Lawson, 1977) and the new triangles are not
/// flipped on the sphere. The mesh stays closed, manifold, of genus 0, and its map one to one. A
/// mesh with openings keeps its triangles.
///
/// \param surface that the mesh was sampled from.
/// \param mesh    of resampleSurface(); changed in place. The best result of sliding is kept.
/// \param threads 0: one for each processor; [0, 1024]
/// \return the report.
/// \throw InvalidInput for sizes that do not match, or threads out of range.
/// The same, bit by bit, for any number of threads.
UntanglingReport untangle(const SphereSurface& surface, ResampledMesh& mesh, int threads = 0);

/// A surface as a square image of positions (Gu, Gortler and Hoppe 2002), on an unfolded octahedron
/// (Praun and Hoppe 2003). Pixels (0, j) and (0, side - 1 - j) of the border coincide, likewise on
/// the other sides; the four corners coincide.
struct GeometryImage {
  int side = 0;         ///< pixels along each side: 2 f + 1 for a grid of frequency f
  Positions positions;  ///< 3 x side^2, row by row, pixel (row, column) at row * side + column
};

/// The geometry image of a mesh with the grid of makeGridSphere() for SphereGrid::Octahedral, from
/// resampleSurface() or untangle(), whose flipped edges an image does not have.
///
/// \param mesh with such vertices, which may have slid.
/// \return the image, whose pixels are the vertices.
/// \throw InvalidInput for another number of vertices.
GeometryImage geometryImageOfMesh(const ResampledMesh& mesh);

/// @}

}  // namespace spherical_param
