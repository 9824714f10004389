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

/// Takes apart for good the few triangles of a mesh that still intersect. For each of them, the
/// first of these that helps:
///
/// 1. a triangulation of the triangles within two steps that has fewer intersections, of up to 100;
/// 2. if the mesh is closed, one of its vertices, or of a triangle that it intersects, is taken out
///    by flips and a 3-to-1 merge, which keeps the topology;
/// 3. it is left out, or one that it intersects, if the others stay a manifold;
/// 4. a vertex is taken out even if as many intersections are left.
///
/// \param points 3 x n.
/// \param pairs  all that intersect, of the triangles of `mesh`.
/// \param most   that may be taken out.
/// \param mesh   changed only if no triangles intersect afterwards.
/// \return what was taken out; nothing if triangles still intersect.
std::optional<Removal> clearIntersections(const Positions& points,
                                          const IntersectingTriangles& pairs, const Removal& most,
                                          SphereMesh& mesh);

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
