#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Where a direction meets a triangulated sphere.
struct SphereHit {
  Index triangle = -1;                                ///< -1: nowhere
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< barycentric, in the flat triangle
};

/// Finds the triangle of a triangulated sphere that holds a direction: a tree of bounding boxes
/// over the spherical triangles, split at medians, as they differ in size by many orders of
/// magnitude; then the exact signs of the sides of their cones. Triangles whose determinants are
/// all positive and that wind around the centre once leave no direction out.
class SphereLocator {
public:
  /// Both must outlive the locator.
  ///
  /// \param sphere 3 x v, unit vectors; \param triangles 3 x m, m > 0, none flipped.
  SphereLocator(const Positions& sphere, const Triangles& triangles, int threads);

  /// On an edge or at a corner, the triangle of lowest index among those that share it.
  ///
  /// \param direction finite, not zero, of any length.
  SphereHit locate(const Eigen::Vector3d& direction) const;

private:
  /// Weights of the corners of a triangle at a direction.
  /// \param sides signs of the determinants of the direction and the side opposite to each corner
  Eigen::Vector3d weightsIn(Index triangle, const Eigen::Vector3d& unit,
                            const Eigen::Vector3i& sides) const;

  struct Box {
    double lower[3];
    double upper[3];
  };

  Box boxOf(Index triangle) const;
  std::size_t begin(std::size_t leaf) const;
  /// Splits the triangles of a node at their median.
  void split(std::size_t node, unsigned level, const Positions& centers);
  void makeBox(std::size_t node);

  const Positions* sphere_;
  const Triangles* triangles_;
  unsigned levels_ = 0;       ///< of nodes with two parts; there are 2^levels_ leaves
  std::vector<Index> order_;  ///< triangles, leaf by leaf
  std::vector<Box> boxes_;    ///< node i has the parts 2 i and 2 i + 1; the root is 1
};

}  // namespace spherical_param::internal
