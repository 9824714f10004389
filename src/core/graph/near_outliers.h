#pragma once

#include "indexed.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Nearest neighbours to which nearOutliers() fits a surface.
constexpr int kFittedNeighbors = 20;

/// Distances of outliers near a surface.
///
/// \param points  3 x n, finite, distinct.
/// \param lists   n lists of the kFittedNeighbors nearest others of each point, with or without the
///                point itself; shorter ones give 0.
/// \return n entries: 0 for a point of the surface, else its distance [spacing there].
Indexed<double> nearOutliers(const Positions& points, const NeighborLists& lists, int threads);

}  // namespace spherical_param::internal
