#pragma once

#include "common/point_data.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace spherical_param::tools {

/// How outliers are told from the points of a surface.
enum class OutlierMethod {
  Paper,        ///< spherical_param::findOutliers()
  Statistical,  ///< pcl::StatisticalOutlierRemoval on the mean distance to 16 neighbours
};

/// Points of a cloud that do not belong to its surface.
struct OutlierRemoval {
  std::vector<int> indices;        ///< the outliers, ascending; of equal points all or none
  std::vector<int> kept;           ///< all others, ascending, those that are not finite included
  std::size_t kept_positions = 0;  ///< distinct finite points among `kept`
  std::optional<double>
      threshold;  ///< of the scores that were compared; PCL keeps its own to itself
};

/// Finds the outliers among the finite points.
///
/// \param sigma   further off than the mean by so many standard deviations; [0, 1000].
/// \param threads 0: as many as OpenMP would use.
OutlierRemoval findOutlierPoints(const std::vector<Point>& points, OutlierMethod method,
                                 double sigma, int threads);

}  // namespace spherical_param::tools
