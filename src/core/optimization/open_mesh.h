#pragma once

#include "indexed.h"
#include "open_places.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// Open triangles that others do not connect to a loop: they are part of the surface.
std::vector<Index> trianglesWithoutLoop(const SphereMesh& mesh, const OpenPlaces& openings);

/// Triangles around a vertex that follow each other, counter-clockwise.
using Fan = std::vector<Index>;

/// The fans at a vertex of the triangles over openings, or of those of the surface.
///
/// \param is_open for each triangle, 1 if it is over an opening.
/// \param of_open which of them.
std::vector<Fan> fansAt(const SphereMesh& mesh, const Indexed<std::uint8_t>& is_open, Index v,
                        bool of_open);

/// A closed mesh with openings.
struct OpenMesh {
  Triangles triangles;            ///< the closed mesh, changed at the openings
  Indexed<std::uint8_t> is_open;  ///< for each triangle, 1 if it is over an opening
};

/// Decides which triangles of a closed mesh are over openings, so that the others are a manifold
/// with boundary over all vertices. Connected open triangles count if they are next to a loop. A
/// vertex without triangles gets a triangle with an edge of the boundary, or is put into a triangle
/// of the surface. Where openings meet in one vertex, triangles close gaps. The nearest places and
/// narrowest gaps without intersections are preferred.
///
/// \param points    3 x n.
/// \param triangles a closed manifold over the points.
/// \param openings  of the surface.
OpenMesh openMesh(const Positions& points, const Triangles& triangles, const OpenPlaces& openings);

/// The triangles of an open mesh that are on the surface, ascending.
std::vector<Index> trianglesOfSurface(const OpenMesh& mesh);

/// Their number.
std::size_t surfaceCount(const OpenMesh& mesh);

/// Their corners.
Triangles surfaceOf(const OpenMesh& mesh);

}  // namespace spherical_param::internal
