#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Above this length of the mean direction an embedding has collapsed. Unfolded embeddings have
/// means below 0.5, or up to 0.9 after slipping along a tube towards one end. Without a bound the
/// springer on nearest neighbours has 160,719 self-intersections instead of 0.
inline constexpr double kMaxCentroid = 0.95;

/// Whether an embedding with this centroid is at one place of the sphere. NaN counts as collapsed.
inline bool isCollapsed(const Eigen::Vector3d& centroid) {
  return !(centroid.norm() <= kMaxCentroid);
}

}  // namespace spherical_param::internal
