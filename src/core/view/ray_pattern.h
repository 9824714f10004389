#pragma once

#include "spherical_param/types.h"

#include <Eigen/Core>

#include <optional>

namespace spherical_param::internal {

/// Finds out from the sampling of a cloud where its sensor was.
class RayPattern {
public:
  /// \param points 3 x n, of an extent about 1.
  /// \param search among them.
  RayPattern(const Positions& points, const NeighborSearch& search);

  /// Whether a sensor at a place saw the points: the angles between neighbouring rays hardly
  /// change, or the spacing grows with the distance.
  bool isSensor(const Eigen::Vector3d& place) const;
  /// Whether the spacing grows with the distance from a place, unlike on an object around it.
  bool isSpreadFrom(const Eigen::Vector3d& place) const;

  /// The place from which the angles between neighbouring rays change least; none if they change
  /// too much.
  std::optional<Eigen::Vector3d> find(int threads) const;

private:
  double unevenness(const Eigen::Vector3d& place, bool is_quadratic) const;
  Eigen::Vector3d densest() const;

  Positions points_;  ///< a sample
  Positions nearest_;
  Eigen::VectorXd spacing_;  ///< logarithms
  double spread_ = 0.0;      ///< mean deviation of the logarithm of the nearest distance
};

}  // namespace spherical_param::internal
