#pragma once

#include "progress.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace spherical_param::internal {

/// A cloud as a place sees it: a closed mesh around the place, over the points that no other one
/// hides exactly, and perhaps over one vertex more.
///
/// No two of its triangles intersect, whatever the points. Seen from the place, the corners of each
/// triangle are counter-clockwise, by the exact sign of a determinant, which is checked for all of
/// them, and for both of each flip. So the map to the sphere
/// around the place, x -> (x - place) / |x - place|, takes each triangle to a spherical triangle,
/// one to one, and the triangles around an edge to both sides of its image. It is a covering
/// outside of the vertices, with as many sheets over all directions; the triangles over one of them
/// are counted, and are one. The map is one to one: two triangles with a common point off their
/// common corner or side would have images with one. This holds for any part of the mesh.
struct ViewMesh {
  Eigen::Vector3d place;      ///< near the one that was wanted
  Triangles triangles;        ///< outward from the place
  Index behind = -1;          ///< a vertex behind the place, after the points; -1: none
  std::vector<Index> hidden;  ///< points that are not in the mesh, ascending
};

/// Unit vectors from a place to points; +z to a point there, or beyond the range of double.
Positions directionsFrom(const Eigen::Vector3d& place, const Positions& points);

/// The Delaunay triangulation of the directions from a place, which is moved a little if points
/// hide others exactly.
///
/// \param points 3 x n, finite, distinct, of an extent about 1; n >= 4.
/// \return the mesh; without triangles if there is none, as for points in one plane with the place.
/// Cost: O(n log n).
ViewMesh triangulateView(const Positions& points, const Eigen::Vector3d& place,
                         const FractionReport& report);

/// Flips edges of a mesh, while it stays one as the place sees it, to the least energy of
/// optimizeMesh().
///
/// \param ends whether the flips have to end early.
void flipInView(const Positions& points, ViewMesh& view, const Execution& execution,
                const std::function<bool()>& ends);

}  // namespace spherical_param::internal
