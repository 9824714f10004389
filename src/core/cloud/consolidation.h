#pragma once

#include "neighbor_search.h"
#include "spherical_param/execution.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"
#include "tangent_stars.h"

#include <vector>

namespace spherical_param {

/// Points on the surface that a noisy cloud samples.
struct Consolidation {
  Positions points;                   ///< 3 x m, m <= n, distinct [unit of the input]
  std::vector<Index> point_of_input;  ///< n entries: point of each input point
  std::vector<Index> distinct_at;     ///< m entries: number of distinct input points there
  ConsolidationReport report;         ///< noise, merging
};

/// Moves noisy points to the sampled surface and merges points that are closer than their noise, so
/// that the layers of merged scans become one.
///
/// Points move to the quadric of moving least squares through their neighbours (Levin 2004,
/// "Mesh-independent surface interpolation"), twice. Neighbourhoods are large enough to be flat;
/// from there, leave-one-out cross-validation chooses among four sizes. Where they are large, fewer
/// points move. At the end, points that noise does not separate are merged, and each of the others
/// is merged with the nearest.
///
/// \param points 3 x n, finite.
/// \param execution threads, progress
/// \return the points, ordered by the first input point of each; the same, bit by bit, for any
///         number of threads. Fewer than 20 distinct points are returned as they are.
/// \throw InvalidInput for a point that is not finite; Cancelled.
/// Cost: O(n log n), some 250 neighbours in fits of quadrics for each point.
///
/// No guarantees: edges are rounded over the size of the neighbourhood. Leave out outliers first,
/// \see findOutliers. Isolated points stay where they are.
Consolidation consolidate(const Positions& points, const Execution& execution = {});

namespace internal {

/// Whether a cloud is so noisy that a mesh through its points folds.
///
/// \param points 3 x n, with their neighbours and stars. Too few points are not noisy.
/// Cost: that of a comparison of the stars, and of 400 fits where they disagree.
bool isNoisy(const Positions& points, const Neighbors& neighbors, const Stars& stars,
             const Execution& execution);

/// The quantile of the distances of points from a mesh, measured to the triangles around the vertex
/// of each.
///
/// \param fraction        of the quantile, in [0, 1].
/// \param vertex_of_point -1 for points that do not count.
double distanceWithin(double fraction, const Positions& points,
                      const std::vector<Index>& vertex_of_point, const Positions& vertices,
                      const Triangles& triangles, int threads);

}  // namespace internal

}  // namespace spherical_param
