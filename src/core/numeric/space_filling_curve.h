#pragma once

#include "power_of_two.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// The Morton curve of a bounding cube (21 bits an axis; G. M. Morton, 1966).
class MortonCurve {
public:
  /// The cube begins at `low` and reaches as far as `high` does at most along an axis.
  MortonCurve(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  /// Where a point in the cube lies along the curve.
  std::uint64_t key(const Eigen::Vector3d& point) const;

private:
  double half_;  ///< 1/2 if the extent is beyond the range of double, else 1
  Eigen::Vector3d low_;
  PowerOfTwo scaled_;  ///< brings the cube to an extent of about 1
  double scale_;
};

/// Order of points along the Morton curve of their bounding cube: points that are near in space are
/// mostly near in the order. Ties go by index.
std::vector<Index> mortonOrder(const Positions& points);

/// Order in which points on the sphere go into a triangulation fast: rounds of growing size, each
/// a random sample of what is left (biased randomised insertion order: N. Amenta, S. Choi and G.
/// Rote, "Incremental constructions con BRIO", 2003), each along a Hilbert curve over the sphere,
/// so that a point is near the one before it. The curve is refined wherever points crowd, to
/// coordinates that differ by one unit in the last place. The same on every platform.
///
/// \param directions 3 x n, unit vectors up to rounding.
std::vector<Index> insertionOrder(const Positions& directions);

}  // namespace spherical_param::internal
