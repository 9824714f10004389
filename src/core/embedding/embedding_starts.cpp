#include "embedding_starts.h"

#include <algorithm>
#include <limits>

namespace spherical_param::internal {

Positions projectFromCentroid(const Positions& points) {
  if (points.cols() == 0)
    return points;
  // Scaled first: neither the sum nor the squares may overflow.
  Positions directions =
      points / std::max(points.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  directions.colwise() -= Eigen::Vector3d(directions.rowwise().mean());
  for (auto direction : directions.colwise()) {
    const double length = direction.stableNorm();
    direction = length > 0.0 ? Eigen::Vector3d((direction / length).normalized())
                             : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  }
  return directions;
}

}  // namespace spherical_param::internal
