#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// An embedding with a longer mean of its directions has collapsed. Unfolded embeddings have means
/// below 0.5, those that slipped along a tube towards one of its ends up to 0.9.
/// Without a bound the springer on nearest neighbours has 160,719 self-intersections instead of 0.
inline constexpr double kMaxCentroid = 0.95;

/// Whether nearly all nodes are around one place of the sphere.
///
/// \param directions 3 x n, unit vectors; NaN counts as collapsed.
inline bool isCollapsed(const Positions& directions) {
  return !(directions.rowwise().mean().norm() <= kMaxCentroid);
}

}  // namespace spherical_param::internal
