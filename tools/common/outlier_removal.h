#pragma once

#include "common/point_data.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
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

/// Whoever asked for the outliers does not want them any more.
class Unwanted : public std::runtime_error {
public:
  Unwanted() : std::runtime_error("the outliers are not wanted any more") {}
};

/// Finds the outliers among the finite points.
///
/// \param sigma   further off than the mean by so many standard deviations; [0, 1000].
/// \param threads 0: as many as OpenMP would use.
/// \param is_wanted asked now and then while neighbours are searched for the paper's method; may be
///                  empty.
/// \throw Unwanted as soon as is_wanted is seen to be false.
OutlierRemoval findOutlierPoints(const std::vector<Point>& points, OutlierMethod method,
                                 double sigma, int threads,
                                 const std::function<bool()>& is_wanted = {});

}  // namespace spherical_param::tools
