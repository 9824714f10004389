#pragma once

#include "part_mesh.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Whether triangles that intersect are taken apart.
bool removesIntersections(const Options& options);

/// Whether triangles that intersect may be left out of some meshes.
bool mayLeaveOutTriangles(const Options& options);

/// Whether triangles that intersect may be left out of this mesh: it is open, or a tangle.
bool mayLeaveOutTriangles(const Options& options, const PartMesh& mesh);

/// Removes the intersections of a mesh if the options say so and time is left, by the first of
/// these that leaves none:
///
/// 1. clearIntersections(), of at most 0.2 % of the points and 1 % of the triangles;
/// 2. leaveOutTangles(), of at most a tenth of the triangles.
///
/// A mesh that stays closed loses no triangles, and at most 0.1 % of the points.
///
/// \param points nodes.
/// \param mesh   optimised and opened; its mesh is unchanged if triangles still intersect.
void cleanMesh(const Positions& points, const Options& options, const Execution& execution,
               PartMesh& mesh);

/// Makes a mesh of the faces of a graph, without those that intersect. Returns whether it has at
/// least a third of the points.
bool takeCertainFaces(const Positions& points, const SphereMesh& faces, const Execution& execution,
                      PartMesh& mesh);

}  // namespace spherical_param::internal
