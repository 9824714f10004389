#pragma once

#include "mesh_optimization.h"
#include "open_places.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// optimizeMesh() of a surface with openings: triangles over them do not bend and do not intersect.
/// Those to which no loop leads are taken for surface in the end.
///
/// \param openings nullptr: the surface is closed.
MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OpenPlaces* openings,
                              const OptimizationOptions& options, std::uint32_t seed,
                              const Execution& execution);

/// The triangles over openings that are not connected to a loop by others: those are part of the
/// surface.
std::vector<Index> trianglesWithoutLoop(const SphereMesh& mesh, const OpenPlaces& openings);

/// A closed mesh with openings.
struct OpenMesh {
  Triangles triangles;                ///< the closed mesh, changed over the openings and beside
  std::vector<std::uint8_t> is_open;  ///< for each triangle, 1 if it is over an opening
};

/// Decides which triangles of a closed mesh are over openings, so that the others are a manifold
/// with boundary over all vertices: connected open triangles count if they are next to a loop. A
/// vertex without a triangle gets one, with an edge of the boundary, or is put into one of the
/// surface; where openings meet in one vertex, gaps are closed there by triangles. Of the nearest
/// places and the narrowest gaps those are taken that intersect nothing, if there are such.
///
/// \param points    3 x n.
/// \param triangles a closed manifold of genus 0 over the points.
/// \param openings  of the surface.
OpenMesh openMesh(const Positions& points, const Triangles& triangles, const OpenPlaces& openings);

/// The triangles of an open mesh that are on the surface, in their order.
Triangles surfaceOf(const OpenMesh& mesh);

}  // namespace spherical_param::internal
