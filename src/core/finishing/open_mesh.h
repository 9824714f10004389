#pragma once

#include "open_places.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// Decides which triangles of a closed mesh are over openings, so that the others are a manifold
/// with boundary over all vertices. Connected open triangles count if they are next to a loop. A
/// vertex without triangles gets a triangle with an edge of the boundary, or is put into a triangle
/// of the surface. Where openings meet in one vertex, triangles close gaps. The nearest places and
/// narrowest gaps without intersections are preferred.
///
/// \param points   3 x n.
/// \param openings of the surface.
/// \param mesh     closed, over the points; it may change at the openings.
void openMesh(const Positions& points, const OpenPlaces& openings, SphereMesh& mesh);

}  // namespace spherical_param::internal
