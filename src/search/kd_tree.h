#pragma once

#include "spherical_param/types.h"

#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/matrix.h>
#include <flann/util/result_set.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Squared distance in space. With a distance of our own the tree is none of those in PCL's
/// libraries, which open a parallel region in each query and would take the place of ours.
template <typename Scalar>
struct SquaredDistance {
  using is_kdtree_distance = bool;
  using ElementType = Scalar;
  using ResultType = Scalar;

  template <typename A, typename B>
  Scalar operator()(A a, B b, std::size_t /*dimensions*/, Scalar /*worst*/ = -1) const {
    const Scalar x = a[0] - b[0];
    const Scalar y = a[1] - b[1];
    const Scalar z = a[2] - b[2];
    return x * x + y * y + z * z;
  }
  Scalar accum_dist(Scalar a, Scalar b, int /*axis*/) const { return (a - b) * (a - b); }
};

/// FLANN's k-d tree of some points, with coordinates and distances of type Scalar.
///
/// Single precision suits points that are in single precision, of an extent of about 1: squared
/// distances underflow for small clouds and overflow for large ones. FLANN's headers need lz4 on
/// some systems.
template <typename Scalar>
class KdTree {
public:
  /// \param points distinct. Those that are near should be near in memory.
  explicit KdTree(const Positions& points)
      : coordinates_(points.cast<Scalar>()),
        index_(flann::Matrix<Scalar>(coordinates_.data(), size(), 3),
               flann::KDTreeSingleIndexParams(kLeafSize)) {
    index_.buildIndex();
  }
  KdTree(const KdTree& other) = delete;  // the tree points into the coordinates
  KdTree& operator=(const KdTree& other) = delete;

  std::size_t size() const { return static_cast<std::size_t>(coordinates_.cols()); }

  /// Writes the nearest points of each query, the point itself among them: `neighbors` for each, at
  /// most size(), one after the other. For many queries at a time, from several threads if wanted.
  void find(const Index* queries, std::size_t count, std::size_t neighbors, Index* found) const {
    const flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
    // One by one: FLANN's own loop is a parallel region, which no exception may leave.
    flann::KNNSimpleResultSet<Scalar> nearest(neighbors);
    std::vector<std::size_t> points(neighbors);
    std::vector<Scalar> distances(neighbors);
    for (std::size_t i = 0; i < count; ++i) {
      nearest.clear();
      index_.findNeighbors(nearest, coordinates_.col(queries[i]).data(), parameters);
      const std::size_t size = std::min(nearest.size(), neighbors);
      nearest.copy(points.data(), distances.data(), size, true);
      for (std::size_t k = 0; k < size; ++k)
        found[i * neighbors + k] = static_cast<Index>(points[k]);
    }
  }

private:
  static constexpr int kLeafSize = 15;  ///< as in PCL

  Eigen::Matrix<Scalar, 3, Eigen::Dynamic> coordinates_;
  flann::KDTreeSingleIndex<SquaredDistance<Scalar>> index_;
};

}  // namespace spherical_param::internal
