#pragma once

#include "spherical_param/reconstruct.h"

#include <functional>

namespace spherical_param::python {

/// Finds nearest neighbours by a k-d tree in double precision: points far from the origin, or very
/// close to each other, lose no digits.
///
/// \param report told of the share of the first search that is done; it may throw to end the work.
NeighborSearchFactory neighborSearch(int threads, const std::function<void(double)>& report);

/// The `count` nearest neighbours of each point, and the point itself.
/// \param points 3 x n, distinct.
NeighborLists nearestNeighbors(const Positions& points, int count, int threads,
                               const std::function<void(double)>& report);

}  // namespace spherical_param::python
