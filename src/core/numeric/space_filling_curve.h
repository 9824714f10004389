#pragma once

#include "spherical_param/types.h"

#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// The Morton curve of a bounding cube (21 bits an axis; G. M. Morton, 1966).
class MortonCurve {
public:
  /// The cube from `low` that contains `high`.
  MortonCurve(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  /// Position of a point of the cube along the curve.
  std::uint64_t key(const Eigen::Vector3d& point) const;

private:
  double half_;  ///< 1/2 if the extent is beyond the range of double, else 1
  Eigen::Vector3d low_;
  int exponent_;  ///< of a power of two that brings the cube to an extent of about 1
  double scale_;
};

/// Order of points along the Morton curve of their bounding cube; ties by index.
std::vector<Index> mortonOrder(const Positions& points);

/// Order for fast insertion of points on the sphere: rounds of growing size, each a random sample
/// of the remaining points (biased randomised insertion order: N. Amenta, S. Choi and G. Rote,
/// "Incremental constructions con BRIO", 2003) along a Morton curve, so that consecutive points are
/// near. Where points are dense, the curve is refined to the last bit of the coordinates. The same
/// on every platform.
///
/// \param directions 3 x n, unit vectors up to rounding.
std::vector<Index> insertionOrder(const Positions& directions);

}  // namespace spherical_param::internal
