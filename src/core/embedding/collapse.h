#pragma once

#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Above this length of the mean direction an embedding has collapsed. Unfolded embeddings have
/// means below 0.5, or up to 0.9 after slipping along a tube towards one end. Without a bound the
/// springer on nearest neighbours has 160,719 self-intersections instead of 0.
inline constexpr double kMaxCentroid = 0.95;

/// The centroid of the nodes.
///
/// \param masses n entries of sum 1, or empty: all alike.
inline Eigen::Vector3d centroidOf(const Positions& directions, const Eigen::VectorXd& masses) {
  return masses.size() > 0 ? Eigen::Vector3d(directions * masses)
                           : Eigen::Vector3d(directions.rowwise().mean());
}

/// Whether nearly all nodes are at one place of the sphere.
///
/// \param directions 3 x n, unit vectors; NaN counts as collapsed.
inline bool isCollapsed(const Positions& directions, const Eigen::VectorXd& masses = {}) {
  return !(centroidOf(directions, masses).norm() <= kMaxCentroid);
}

}  // namespace spherical_param::internal
