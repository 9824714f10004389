#pragma once

#include "indexed.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// A flat disc of radius 1, triangulated in rings. Each ring has 0.7 times as many vertices as the
/// next outer ring; their distance is the mean of their edge lengths. Inside the last ring, of at
/// most 9 vertices, is a pole. In all, up to 2.4 times as many vertices inside as on the rim.
struct RingedDisc {
  Indexed<double> angles;  ///< of the vertices [rad]: the rim, ring by ring, the pole
  Indexed<double> radii;   ///< of the vertices, 1 at the rim
  Triangles triangles;     ///< clockwise: a rim that has a surface on its left is continued

  /// Distance of two vertices.
  double distance(Index a, Index b) const;
};

/// \param rim angles of the vertices of the rim, 3 or more, ascending from 0, below 2 pi; two
///            neighbours may have the same.
RingedDisc ringedDisc(const std::vector<double>& rim);

}  // namespace spherical_param::internal
