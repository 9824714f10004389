#pragma once

#include "part_mesh.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Whether triangles that intersect are taken apart.
bool removesIntersections(const Options& options);

/// Whether triangles of a mesh that intersect may be left out: of an open one, or of a tangle.
bool mayLeaveOutTriangles(const Options& options, const PartMesh& mesh);

/// Removes the intersections of a mesh for good, if the options say so and time is left. The first
/// of these that leaves none:
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

/// Makes the faces of a graph the mesh, without those that intersect, if a third of the points is
/// in it. Returns whether it is.
bool takeCertainFaces(const Positions& points, const SphereMesh& faces, const Execution& execution,
                      PartMesh& mesh);

}  // namespace spherical_param::internal
