#pragma once

#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup texture
/// @{

/// A mesh that is cut along its handles, so that it maps to one sphere.
struct CutMesh {
  Positions points;     ///< 3 x w: the v vertices of the mesh, then their copies along the cuts
  Triangles triangles;  ///< 3 x m, those of the mesh in their order: genus 0, in one piece
  std::vector<Index> vertex_of;  ///< w entries: the vertex of the mesh; v entries without handles
};

/// Cuts a mesh along short loops, one for each handle.
///
/// \param points    3 x v, finite [unit of the input].
/// \param triangles 3 x m, manifold, consistently oriented, in one piece, every vertex used; closed
///                  or with openings, of any genus g.
/// \return the mesh with two openings more for each handle, less where loops touch openings or each
/// other; a mesh of genus 0 as it is.
/// \throw InvalidInput for other meshes, and for more than 2^31 / 3 triangles.
///
/// Of the shortest loops through a vertex that do not bound (J. Erickson and K. Whittlesey, 2005,
/// "Greedy optimal homotopy and homology generators") the shortest is taken and, as long as that
/// gets shorter, the one through the vertex opposite to it. Cost: O(v); for each handle a few
/// searches of O(v log v).
CutMesh cutHandles(const Positions& points, const Triangles& triangles);

/// The atlas of a mesh, from that of the mesh after it was cut: the cuts are closed in space, and
/// stay in the chart. A checkerboard is baked before, as it needs the sphere of the cut mesh.
///
/// \param atlas of cut.triangles.
/// \param cut   from cutHandles().
/// \return an atlas whose first v vertices are those of the mesh. Where the chart divides an edge
/// on one side of a cut, the triangle on the other side is divided, too. \throw InvalidInput for an
/// atlas that cannot be one of that mesh.
TextureAtlas joinCuts(TextureAtlas atlas, const CutMesh& cut);

/// @}

}  // namespace spherical_param
