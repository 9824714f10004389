#pragma once

#include "box_tree.h"
#include "spherical_param/map/sphere_surface.h"

#include <vector>

namespace spherical_param::internal {

/// Finds the triangle of a triangulated sphere that holds a direction: by a tree of bounding boxes
/// of the spherical triangles, then by the exact signs of the sides of their cones. Triangles whose
/// determinants are all positive and that wind around the centre once leave no direction out.
class SphereLocator {
public:
  /// Both must outlive the locator.
  ///
  /// \param sphere 3 x v, unit vectors; \param triangles 3 x m, m > 0, none flipped.
  SphereLocator(const Positions& sphere, const Triangles& triangles, int threads);

  /// On an edge or at a corner, the triangle of lowest index among those that share it.
  ///
  /// \param direction finite, not zero, of any length.
  /// \return of triangle -1 if the direction meets none
  SphereLocation locate(const Eigen::Vector3d& direction) const;

private:
  Eigen::Matrix3d corners(Index triangle) const;

  const Positions* sphere_;
  const Triangles* triangles_;
  std::vector<Index> order_;  ///< triangles along a curve over the sphere
  BoxTree tree_;              ///< of their boxes
};

}  // namespace spherical_param::internal
