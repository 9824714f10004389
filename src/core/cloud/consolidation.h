#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// Points on the surface that a noisy cloud samples.
struct Consolidation {
  Positions points;                   ///< 3 x m, m <= n, distinct [unit of the input]
  std::vector<Index> point_of_input;  ///< n entries: point of each input point
  std::vector<Index> distinct_at;     ///< m entries: number of distinct input points there
  ConsolidationReport report;         ///< noise, merging, displacements
};

/// Moves noisy points to the sampled surface and merges points that are closer than their noise, so
/// that the layers of merged scans become one.
///
/// Each point moves to the quadric of moving least squares through its neighbours (Levin 2004,
/// "Mesh-independent surface interpolation"). Leave-one-out cross-validation chooses among three
/// sizes of neighbourhoods. Where noise far above the spacing makes neighbourhoods isotropic, about
/// three points at a time are merged first, which averages the noise.
///
/// \param points 3 x n, finite.
/// \param execution threads, progress
/// \return the points, ordered by the first input point of each; the same, bit by bit, for any
///         number of threads. Fewer than 20 distinct points are returned as they are.
/// \throw InvalidInput for a point that is not finite; Cancelled.
/// Cost: that of the 60 nearest neighbours and of four fits of a quadric for each point.
///
/// No guarantees: edges are rounded over the size of the neighbourhood. Leave out outliers before,
/// \see findOutliers. Isolated points stay where they are.
Consolidation consolidate(const Positions& points, const Execution& execution = {});

}  // namespace spherical_param
