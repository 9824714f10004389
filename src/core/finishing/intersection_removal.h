#pragma once

#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace spherical_param::internal {

using IntersectingTriangles = std::vector<std::array<Index, 2>>;

/// How much of a mesh is taken out.
struct Removal {
  std::size_t vertices = 0;
  std::size_t triangles = 0;  ///< without those around the vertices
};

/// Takes apart the few triangles of a mesh that still intersect. Does for each of them the first of
/// these that leaves fewer intersections:
///
/// 1. takes out two to 128 vertices near it, by flips and 3-to-1 merges, which keep the topology,
///    and puts them back one by one where they intersect least (ruin and recreate);
/// 2. if the mesh is closed, leaves out a vertex of it or of a triangle that it intersects;
/// 3. leaves out this triangle or one that it intersects, if the others stay a manifold;
/// 4. leaves out a vertex even if there are a few more intersections then.
///
/// \param points 3 x n.
/// \param pairs  all that intersect, of the triangles of `mesh`.
/// \param most   that may be left out.
/// \param mesh   changed.
/// \return what was left out.
Removal clearIntersections(const Positions& points, const IntersectingTriangles& pairs,
                           const Removal& most, SphereMesh& mesh);

/// Leaves out all triangles that intersect, those with the most intersections first; then the
/// smaller fans at a vertex that has several, and pieces of fewer than 50 triangles, but the
/// largest. Vertices may be left without triangles.
///
/// \param pairs all that intersect, of the triangles of `mesh`.
/// \param mesh  with at least one triangle that intersects none.
/// \return the number of triangles that were left out because they intersect.
std::size_t leaveOutTangles(std::size_t vertices, const IntersectingTriangles& pairs,
                            SphereMesh& mesh);

}  // namespace spherical_param::internal
