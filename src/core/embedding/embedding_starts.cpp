#include "embedding_starts.h"

#include "pi.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherical_param::internal {
namespace {

/// The points about their centroid, scaled first: neither the sum nor the squares may overflow.
///
/// \param points 3 x n, finite, n >= 1.
Positions scaledAndCentered(const Positions& points) {
  const double scale = std::max(points.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  Positions centered = points / scale;
  centered.colwise() -= Eigen::Vector3d(centered.rowwise().mean());
  return centered;
}

/// A direction for node i where none is defined, spread evenly over the sphere by the golden angle.
Eigen::Vector3d anyDirection(Index i, Index n) {
  const double height = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
  const double golden_angle = kPi * (3.0 - std::sqrt(5.0));
  const double angle = golden_angle * static_cast<double>(i);
  const double radius = std::sqrt(std::max(0.0, 1.0 - height * height));
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

}  // namespace

Positions projectFromCentroid(const Positions& points) {
  const auto n = static_cast<Index>(points.cols());
  if (n == 0)
    return points;
  Positions directions = scaledAndCentered(points);
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector3d centered = directions.col(i);
    const double length = centered.stableNorm();
    directions.col(i) =
        length > 0.0 ? Eigen::Vector3d((centered / length).normalized()) : anyDirection(i, n);
  }
  return directions;
}

}  // namespace spherical_param::internal
