#pragma once

#include "spherical_param/types.h"

#include <functional>
#include <vector>

namespace spherical_param::internal {

/// A mesh whose openings are closed by caps.
struct CappedMesh {
  Positions points;     ///< 3 x (v + c), those of the mesh first
  Triangles triangles;  ///< 3 x (2 (v + c) - 4), those of the mesh first
};

/// Puts a cap in each opening: a ringed disc, whose vertices are between the loop and its centroid.
///
/// \param points    3 x v.
/// \param triangles 3 x m, a consistently oriented manifold with boundary over all points.
CappedMesh capOpenings(const Positions& points, const Triangles& triangles);

/// Numbers the vertices that triangles use anew, in their order. \return those that were used,
/// ascending
std::vector<Index> compact(Triangles& triangles, Eigen::Index vertex_count);

/// Cuts openings into a triangulated sphere. Vertices near their boundaries are moved to them,
/// along edges, so that triangles keep their shapes; triangles of vertices in openings and on
/// boundaries alone are left out. The rest is manifold, and empty if all is open.
///
/// \param directions 3 x n, unit vectors; \param triangles 3 x m, of the sphere.
/// \param is_open    whether a direction is in an opening; called by several threads.
void cutOpenings(Positions& directions, Triangles& triangles,
                 const std::function<bool(const Eigen::Vector3d&)>& is_open);

}  // namespace spherical_param::internal
