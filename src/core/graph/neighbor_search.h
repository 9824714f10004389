#pragma once

#include "rows.h"
#include "spherical_param/execution.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace spherical_param {

/// Builds a k-d tree of points, in double precision.
///
/// \param points 3 x n, n >= 1, finite; copied. Sort them by mortonOrder() and scale them to an
///               extent of about 1, so that squared distances neither overflow nor underflow.
/// \param execution threads, progress; its progress callback must outlive the search.
/// \return a search among these points; copies of it share the tree. It throws InvalidInput for
///         queries out of [0, n) and for lists of more than 2^31 entries in all; Cancelled.
/// \throw InvalidInput for no points; std::bad_alloc.
/// Cost: O(n log n), and O(log n) for each query, typically.
NeighborSearch makeNeighborSearch(const Positions& points, const Execution& execution = {});

/// A neighbour of a point.
struct NearPoint {
  double squared_distance;
  Index point;
  Eigen::Vector3d offset;  ///< from the other point

  bool operator<(const NearPoint& other) const {
    return std::pair(squared_distance, point) < std::pair(other.squared_distance, other.point);
  }
};

/// The nearest other points of a list to point i, at most `count`: nearest first, ties by index.
///
/// \param list in any order, perhaps with repetitions and the point itself.
std::vector<NearPoint> nearestOthers(const Positions& points, Index i,
                                     const internal::Row<Index>& list,
                                     std::size_t count = std::numeric_limits<std::size_t>::max());

/// Neighbour lists of all nodes, and a search for longer lists.
struct Neighbors {
  NeighborLists lists;
  NeighborSearch search;  ///< may be empty
};

/// A sample of at most `most` points, at even steps; ascending.
inline std::vector<Index> sampleOf(const Positions& points, Eigen::Index most) {
  const Eigen::Index n = std::min(points.cols(), most);
  std::vector<Index> sample;
  for (Eigen::Index i = 0; i < n; ++i)
    sample.push_back(static_cast<Index>(i * points.cols() / n));
  return sample;
}

/// The `count` nearest neighbours of all points. \see makeNeighborSearch
///
/// \param points 3 x n, finite.
/// \param count  of neighbours, not counting the point itself, which is in its list.
/// \param execution threads, progress
/// \return n lists.
/// \throw InvalidInput for lists of more than 2^31 entries in all; Cancelled.
NeighborLists findNearestNeighbors(const Positions& points, int count,
                                   const Execution& execution = {});

/// The nearest point to each of some places.
///
/// \param points 3 x n, n >= 1, finite.
/// \param places 3 x m, finite.
/// \return m indices of points.
std::vector<Index> findNearest(const Positions& points, const Positions& places,
                               const Execution& execution);

}  // namespace spherical_param
