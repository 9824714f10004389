#include "neighbor_search.h"

#include "progress.h"
#include "spherical_param/errors.h"

#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/matrix.h>
#include <flann/util/result_set.h>

#include <algorithm>
#include <memory>
#include <string>

namespace spherical_param {
namespace {

/// Squared distance in space. With FLANN's own distances the linker could take the trees of PCL's
/// libraries for this one, and these open a parallel region for each query.
struct SquaredDistance {
  using is_kdtree_distance = bool;  // NOLINT(readability-identifier-naming): FLANN's name
  using ElementType = double;
  using ResultType = double;

  template <typename A, typename B>
  double operator()(A a, B b, std::size_t /*dimensions*/, double /*worst*/ = -1) const {
    const double x = a[0] - b[0];
    const double y = a[1] - b[1];
    const double z = a[2] - b[2];
    return x * x + y * y + z * z;
  }
  // NOLINTNEXTLINE(readability-identifier-naming): FLANN's name
  double accum_dist(double a, double b, int /*axis*/) const { return (a - b) * (a - b); }
};

/// FLANN's k-d tree.
class KdTree {
public:
  explicit KdTree(const Positions& points)
      : points_(points),
        index_(flann::Matrix<double>(points_.data(), internal::columnCount(points), 3),
               flann::KDTreeSingleIndexParams(15)) {  // points of a leaf, as in PCL
    index_.buildIndex();
  }
  KdTree(const KdTree& other) = delete;  // the tree points into the coordinates
  KdTree& operator=(const KdTree& other) = delete;

  NeighborLists search(const std::vector<Index>& queries, int count,
                       const Execution& execution) const;
  /// The nearest point to each of some places.
  std::vector<Index> nearestTo(const Positions& places, const Execution& execution) const;

private:
  struct Nearest {
    std::vector<std::size_t> points;
    std::vector<double> distances;
  };

  /// The `count` nearest points, the nearest first.
  void findNearest(const double* place, std::size_t count, Nearest& nearest) const {
    // For at least this number a heap is faster than a sorted list.
    constexpr std::size_t many = 128;
    if (count < many)
      findNearest<flann::KNNSimpleResultSet<double>>(place, count, nearest);
    else
      findNearest<flann::KNNResultSet2<double>>(place, count, nearest);
  }
  template <typename ResultSet>
  void findNearest(const double* place, std::size_t count, Nearest& nearest) const {
    ResultSet found(count);
    index_.findNeighbors(found, place, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    nearest.points.resize(count);
    nearest.distances.resize(count);
    found.copy(nearest.points.data(), nearest.distances.data(), count, true);
  }

  /// Calls work(memory, query) for each query. FLANN's own loop is a parallel region, which no
  /// exception may leave.
  template <typename Work>
  void forEachQuery(std::size_t count, const Execution& execution, const Work& work) const {
    internal::forEachIndex<Nearest>(count, internal::threadCount(execution.threads, count),
                                    internal::reportOf(execution, "neighbors"), work);
  }

  Positions points_;
  flann::KDTreeSingleIndex<SquaredDistance> index_;
};

NeighborLists KdTree::search(const std::vector<Index>& queries, int count,
                             const Execution& execution) const {
  const std::size_t n = internal::columnCount(points_);
  if (std::any_of(queries.begin(), queries.end(),
                  [&](Index i) { return i < 0 || static_cast<std::size_t>(i) >= n; }))
    throw InvalidInput("makeNeighborSearch: a query is out of range; use 0 to n - 1");
  // One more, since a point is its own neighbour.
  const std::size_t size = std::min(static_cast<std::size_t>(std::max(count, 0)), n - 1) + 1;
  constexpr std::size_t max_entries = std::size_t{1} << 31;
  if (size * queries.size() > max_entries)
    throw InvalidInput("makeNeighborSearch: " + std::to_string(count) + " neighbours of each of " +
                       std::to_string(queries.size()) +
                       " points do not fit into memory; use a smaller k");
  NeighborLists lists;
  for (std::size_t i = 1; i <= queries.size(); ++i)
    lists.offsets.push_back(i * size);
  lists.indices.resize(queries.size() * size);
  forEachQuery(queries.size(), execution, [&](Nearest& nearest, Index query) {
    const auto q = static_cast<std::size_t>(query);
    findNearest(points_.col(queries[q]).data(), size, nearest);
    std::copy(nearest.points.begin(), nearest.points.end(), lists.indices.data() + q * size);
  });
  return lists;
}

std::vector<Index> KdTree::nearestTo(const Positions& places, const Execution& execution) const {
  internal::Indexed<Index> result(internal::columnCount(places));
  forEachQuery(result.size(), execution, [&](Nearest& nearest, Index q) {
    findNearest(places.col(q).data(), 1, nearest);
    result[q] = static_cast<Index>(nearest.points.front());
  });
  return result;
}

}  // namespace

NeighborSearch makeNeighborSearch(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  if (points.cols() == 0)
    throw InvalidInput("makeNeighborSearch: there are no points; give at least one");
  return [tree = std::make_shared<const KdTree>(points),
          execution](const std::vector<Index>& queries, int count) {
    return tree->search(queries, count, execution);
  };
}

std::vector<NearPoint> nearestOthers(const Positions& points, Index i,
                                     const internal::Row<Index>& list, std::size_t count) {
  std::vector<NearPoint> others;
  others.reserve(list.size());
  for (const Index j : list) {
    const Eigen::Vector3d offset = points.col(j) - points.col(i);
    if (j != i)
      others.push_back({offset.squaredNorm(), j, offset});
  }
  if (!std::is_sorted(others.begin(), others.end()))
    std::sort(others.begin(), others.end());
  const auto is_same = [](const NearPoint& a, const NearPoint& b) { return a.point == b.point; };
  others.erase(std::unique(others.begin(), others.end(), is_same), others.end());
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(std::min(count, others.size())),
               others.end());
  return others;
}

NeighborLists findNearestNeighbors(const Positions& points, int count, const Execution& execution) {
  internal::checkThreads(execution.threads);
  if (points.cols() == 0)
    return {};
  const std::vector<Index> all = internal::firstIndices(internal::columnCount(points));
  return makeNeighborSearch(points, execution)(all, count);
}

std::vector<Index> findNearest(const Positions& points, const Positions& places,
                               const Execution& execution) {
  return KdTree(points).nearestTo(places, execution);
}

}  // namespace spherical_param
