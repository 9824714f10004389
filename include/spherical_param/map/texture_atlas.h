#pragma once

#include "spherical_param/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace spherical_param {

/// \addtogroup texture
/// @{

/// How the sphere is laid out in the unit square, u to the right and v up.
enum class SphereChart {
  /// Longitude and latitude: u = (1 + atan2(y, x) / pi) / 2, v = 1/2 + asin(z) / pi. Cut along the
  /// half meridian y = 0, x < 0; images twice as wide as high.
  Equirectangular,
  /// The octahedron |x| + |y| + |z| = 1 unfolded: z >= 0 is the diamond in the middle, z < 0 the
  /// four corners. Cut where x = 0 or y = 0 below the equator. Square images.
  Octahedral,
  /// Six faces of a cube, three in a row, two rows: +x, -x, +y above -y, +z, -z. Images three by
  /// two. Faces keep a margin for the gutter.
  CubeMap,
};

/// A vertex of a cut mesh: a vertex, a point on an edge, or one in a triangle of the mesh.
struct CutVertex {
  std::array<Index, 3> vertices{};                     ///< of the mesh; repeated if fewer than 3
  Eigen::Vector3d weights = Eigen::Vector3d::UnitX();  ///< >= 0, sum 1
};

/// A mesh with texture coordinates. Triangles are cut where the chart is, so none wraps round; the
/// surface in space stays what it was, and no cut opens it.
struct TextureAtlas {
  SphereChart chart = SphereChart::Octahedral;  ///< the layout
  std::vector<CutVertex> vertices;              ///< the first v are those of the mesh, in order
  Triangles triangles;                          ///< 3 x m', indices of `vertices`, outward
  Eigen::Matrix<double, 2, Eigen::Dynamic> coordinates;  ///< 2 x t, (u, v) in [0, 1]
  Triangles coordinate_triangles;  ///< 3 x m', columns of `coordinates` for each triangle
  std::vector<Index> source;       ///< m' entries: triangle of the mesh that each is a part of
};

/// Parameters of makeTextureAtlas().
struct TextureAtlasOptions {
  SphereChart chart = SphereChart::Octahedral;  ///< the layout
  /// Free space around each face of a cube map, as a fraction of its side; [0, 0.25).
  double margin = 1.0 / 64;
};

/// Lays a mesh out in a chart of the sphere.
///
/// \param triangles 3 x m, genus 0, closed or with openings.
/// \param sphere    3 x v, unit vectors; no triangle is flipped.
/// \param options   chart and margin
/// \return the mesh, cut where the chart is, with its texture coordinates.
/// \throw InvalidInput for an invalid mesh, or a triangle flipped on the sphere.
TextureAtlas makeTextureAtlas(const Triangles& triangles, const Positions& sphere,
                              const TextureAtlasOptions& options = {});

/// Values of the mesh's vertices (positions, colours ...) at those of the atlas.
///
/// \param atlas  of that mesh.
/// \param values v columns, one for each vertex of the mesh.
/// \return a column for each vertex of the atlas.
Eigen::MatrixXd atCutVertices(const TextureAtlas& atlas, const Eigen::MatrixXd& values);

/// The place of a direction in a chart.
///
/// \param options   chart and margin
/// \param direction of any length but zero.
/// \return (u, v) in [0, 1]; on a cut, one of its sides.
Eigen::Vector2d chartCoordinates(const TextureAtlasOptions& options,
                                 const Eigen::Vector3d& direction);

/// An image of 8 bits a channel, row by row from the top, three channels a pixel.
struct TextureImage {
  int width = 0;                      ///< pixels
  int height = 0;                     ///< pixels
  std::vector<std::uint8_t> pixels;   ///< 3 x width x height, RGB
  std::vector<std::uint8_t> covered;  ///< width x height; 1: in a triangle, 2: gutter, 0: neither
};

/// Parameters of bakeColors() and bakeCheckerboard().
struct BakeOptions {
  int height = 1024;  ///< pixels; [16, 16384]. The width follows from the chart.
  /// Pixels around the triangles that get the colour of the nearest one, so that filtering finds
  /// no background; [0, 256].
  int gutter = 8;
  int threads = 0;  ///< 0: one for each processor; [0, 1024]
};

/// Paints the colours of a mesh's vertices into a texture, interpolated over its triangles.
///
/// \param atlas   of the mesh.
/// \param colors  3 x v, RGB in [0, 255]: one for each vertex of the mesh (not of the atlas).
/// \param options size of the image, gutter, threads
/// \return the image.
/// \throw InvalidInput for options out of range or a number of colours that does not match.
/// The same, byte by byte, for any number of threads.
TextureImage bakeColors(const TextureAtlas& atlas,
                        const Eigen::Matrix<double, 3, Eigen::Dynamic>& colors,
                        const BakeOptions& options = {});

/// A checkerboard on the sphere, for looking at a map, coloured by the octant.
///
/// \param atlas   of the mesh.
/// \param sphere  3 x v: of each vertex of the mesh.
/// \param cells   squares along each quarter of a great circle.
/// \param options size of the image, gutter, threads
/// \return the image.
TextureImage bakeCheckerboard(const TextureAtlas& atlas, const Positions& sphere, int cells = 8,
                              const BakeOptions& options = {});

/// @}

}  // namespace spherical_param
