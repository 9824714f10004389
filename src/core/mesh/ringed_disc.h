#pragma once

#include "indexed.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// A flat disc of radius 1, triangulated in rings. Each ring has 0.7 times as many vertices as the
/// next outer ring; their distance is the mean of their edge lengths. Inside the last ring, of at
/// most 9 vertices, is a pole. Inside are up to 2.4 times as many vertices as on the boundary.
struct RingedDisc {
  Indexed<double> angles;  ///< of the vertices [rad]: the boundary, ring by ring, the pole
  Indexed<double> radii;   ///< of the vertices, 1 on the boundary
  Triangles triangles;     ///< clockwise: they continue a surface on the left of the boundary

  /// Distance of two vertices.
  double distance(Index a, Index b) const;
};

/// \param boundary angles of the vertices on the boundary, at least 3, ascending from 0 and below
///                 2 pi; neighbours may have the same angle.
RingedDisc ringedDisc(const std::vector<double>& boundary);

}  // namespace spherical_param::internal
