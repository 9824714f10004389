#pragma once

#include "indexed.h"
#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Two triangulations of the sphere at once: their vertices, and the points where edges of one
/// cross edges of the other. Each face is what a triangle of one has in common with a triangle of
/// the other.
struct SphereOverlay {
  Positions directions;           ///< 3 x w: vertices of the first, others of the second, crossings
  Indexed<SphereLocation> first;  ///< w, places in the first mesh, not in a cap if possible
  Indexed<SphereLocation> second;   ///< w, the same in the second mesh
  Indexed<Index> first_triangles;   ///< of each face, in the first mesh
  Indexed<Index> second_triangles;  ///< of each face, in the second mesh
  Indexed<Index> offsets{0};        ///< faces + 1, positions in `corners`
  Indexed<Index> corners;           ///< of the faces, counter-clockwise; convex, 3 to 6 each
};

/// Lays one triangulation of the sphere over another. All decisions are exact: where directions lie
/// in one plane through the centre, they count as moved by infinitesimal amounts that depend on
/// their numbers (H. Edelsbrunner and E. P. Mücke, "Simulation of Simplicity", 1990).
///
/// \param first, second     3 x a and 3 x b, directions; all triangles counter-clockwise, none as
///                          wide as a half circle.
/// \param partner           b: the vertex of the first that is the same place, with equal
///                          coordinates; -1: none.
/// \throw ComputeError if the triangles do not cover the sphere once. Cost: O(w log w).
SphereOverlay overlaySpheres(const Positions& first, const Triangles& first_triangles,
                             const Positions& second, const Triangles& second_triangles,
                             const Indexed<Index>& partner);

}  // namespace spherical_param::internal
