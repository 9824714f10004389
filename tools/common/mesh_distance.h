#pragma once

#include "spherical_param/map/sphere_surface.h"
#include "spherical_param/types.h"

namespace spherical_param::tools {

/// Distances of points from a mesh.
struct DistanceStatistics {
  double mean = 0.0;
  double rms = 0.0;
  double max = 0.0;
};

/// How far points are from a mesh, if both are mapped to the same sphere: from the place that the
/// mesh has at the direction of a point, a search goes on over its triangles as long as they come
/// nearer. Never less than the distance, and mostly the distance itself.
///
/// \param points     3 x n [unit of the mesh]; \param directions 3 x n, unit vectors, theirs.
/// \param mesh       the mesh with its map. Cost: O(n log v), typically.
DistanceStatistics distanceFromMesh(const Positions& points, const Positions& directions,
                                    const SphereSurface& mesh);

}  // namespace spherical_param::tools
