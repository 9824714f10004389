#pragma once

#include "progress.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace spherical_param::internal {

/// A cloud as a place sees it: a closed mesh around the place, over the points that no other point
/// hides exactly, and perhaps one more vertex.
///
/// No two of its triangles intersect, for any points. Seen from the place, the corners of each
/// triangle are counter-clockwise. The exact sign of a determinant shows this for all triangles,
/// and for both of each flip. So the map to the sphere around the place, x -> (x - place) / |x -
/// place|, takes each triangle to a spherical triangle, one to one, and the triangles at an edge to
/// different sides of its image. Outside of the vertices, the map is a covering with the same
/// number of sheets everywhere. One triangle is over some direction, so there is one sheet, and the
/// map is one to one. Two triangles that intersect would have images that overlap. This holds for
/// any part of the mesh.
struct ViewMesh {
  Eigen::Vector3d place;      ///< near the requested one
  Triangles triangles;        ///< outward from the place
  Index behind = -1;          ///< a vertex behind the place, numbered after the points; -1: none
  std::vector<Index> hidden;  ///< points that are not in the mesh, ascending
};

/// Unit vectors from a place to points; +z to a point at the place or beyond the range of double.
Positions directionsFrom(const Eigen::Vector3d& place, const Positions& points);

/// The Delaunay triangulation of the directions from a place, which is moved a little if points
/// hide others exactly.
///
/// \param points 3 x n, finite, distinct, of an extent about 1; n >= 4.
/// \return the mesh; without triangles if there is none, as for points on a line.
/// Cost: O(n log n).
ViewMesh triangulateView(const Positions& points, const Eigen::Vector3d& place,
                         const FractionReport& report);

/// Flips edges to lower the energy of optimizeMesh(), as long as all triangles stay outward.
///
/// \param ends returns whether to end early.
void flipInView(const Positions& points, ViewMesh& view, const Execution& execution,
                const std::function<bool()>& ends);

}  // namespace spherical_param::internal
