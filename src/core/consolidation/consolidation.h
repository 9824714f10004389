#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup consolidation
/// @{

/// Points on the surface that a noisy cloud samples.
struct Consolidation {
  Positions points;                   ///< 3 x m, m <= n, distinct [unit of the input]
  std::vector<Index> point_of_input;  ///< n entries: the point that an input point is part of
  ConsolidationReport report;         ///< noise, and what was done
};

/// Moves noisy points to the surface that they sample, and merges those that are closer than their
/// noise, so that several layers of points, as merged scans have them, become one.
///
/// Each point moves to the quadric of moving least squares through its neighbours (Levin 2004,
/// "Mesh-independent surface interpolation"). How many neighbours count is found from the cloud:
/// of three neighbourhoods, the one is taken from which the points there are best predicted by
/// their neighbours alone (leave-one-out cross-validation). Where the noise is so far above the
/// spacing that neighbourhoods look the same in all directions, the points are first merged by
/// threes or so, which averages the noise.
///
/// \param points 3 x n, finite.
/// \param execution threads, progress
/// \return the points, ordered by the first input point of each; the same, bit by bit, for any
///         number of threads. Fewer than 20 distinct points are returned as they are.
/// \throw InvalidInput for a point that is not finite; Cancelled.
/// Cost: that of the 60 nearest neighbours and of four fits of a quadric for each point.
///
/// No guarantees: edges are rounded over the distance of the neighbours that count. Outliers are to
/// be left out before; single points without a surface nearby stay where they are. \see
/// findOutliers
Consolidation consolidate(const Positions& points, const Execution& execution = {});

/// @}

}  // namespace spherical_param
