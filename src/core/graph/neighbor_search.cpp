#include "neighbor_search.h"

#include "progress.h"
#include "rows.h"
#include "spherical_param/errors.h"

#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/matrix.h>
#include <flann/util/result_set.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

/// Squared distance in space. FLANN's own distances would make the tree one of those in PCL's
/// libraries, which open a parallel region for each query and would take the place of this one.
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
        index_(flann::Matrix<double>(points_.data(), size(), 3),
               flann::KDTreeSingleIndexParams(15)) {  // points of a leaf, as in PCL
    index_.buildIndex();
  }
  KdTree(const KdTree& other) = delete;  // the tree points into the coordinates
  KdTree& operator=(const KdTree& other) = delete;

  std::size_t size() const { return static_cast<std::size_t>(points_.cols()); }

  /// Writes `count` nearest points of each of [begin, end), the point itself among them, one after
  /// the other. One by one: FLANN's own loop is a parallel region, which no exception may leave.
  void find(const Index* begin, const Index* end, std::size_t count, Index* found) const {
    const flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
    flann::KNNSimpleResultSet<double> nearest(count);
    std::vector<std::size_t> points(count);
    std::vector<double> distances(count);
    for (const Index* query = begin; query != end; ++query) {
      nearest.clear();
      index_.findNeighbors(nearest, points_.col(*query).data(), parameters);
      nearest.copy(points.data(), distances.data(), count, true);
      found = std::copy(points.begin(), points.end(), found);
    }
  }

private:
  Positions points_;
  flann::KDTreeSingleIndex<SquaredDistance> index_;
};

NeighborLists search(const KdTree& tree, const std::vector<Index>& points, int count,
                     const Execution& execution) {
  if (std::any_of(points.begin(), points.end(),
                  [n = static_cast<Index>(tree.size())](Index i) { return i < 0 || i >= n; }))
    throw InvalidInput("makeNeighborSearch: a query is out of range; use 0 to n - 1");
  // One more, since a point is its own neighbour.
  const std::size_t size =
      std::min(static_cast<std::size_t>(std::max(count, 0)), tree.size() - 1) + 1;
  constexpr std::size_t max_entries = std::size_t{1} << 31;
  if (size * points.size() > max_entries)
    throw InvalidInput("makeNeighborSearch: " + std::to_string(count) + " neighbours of each of " +
                       std::to_string(points.size()) +
                       " points do not fit into memory; use a smaller k");
  NeighborLists lists;
  for (std::size_t i = 1; i <= points.size(); ++i)
    lists.offsets.push_back(i * size);
  lists.indices.resize(points.size() * size);
  const int threads = internal::threadCount(execution.threads, points.size());
  internal::forEachBlock(points.size(), threads, internal::reportOf(execution, "neighbors"),
                         [&](std::size_t, std::size_t begin, std::size_t end) {
                           tree.find(points.data() + begin, points.data() + end, size,
                                     lists.indices.data() + begin * size);
                         });
  return lists;
}

}  // namespace

NeighborSearch makeNeighborSearch(const Positions& points, const Execution& execution) {
  internal::checkThreads(execution.threads);
  if (points.cols() == 0)
    throw InvalidInput("makeNeighborSearch: there are no points; give at least one");
  return [tree = std::make_shared<const KdTree>(points),
          execution](const std::vector<Index>& queries, int count) {
    return search(*tree, queries, count, execution);
  };
}

NeighborLists searchAll(const NeighborSearch& search, std::size_t n, int count) {
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  return search(all, count);
}

std::vector<Index> nearestOthers(const Positions& points, const NeighborLists& lists, Index i,
                                 std::size_t count) {
  std::vector<std::pair<double, Index>> others;
  for (const Index j : internal::listOf(lists, i))
    if (j != i)
      others.emplace_back((points.col(j) - points.col(i)).squaredNorm(), j);
  internal::sortUnique(others);
  std::vector<Index> nearest(std::min(others.size(), count));
  std::transform(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(nearest.size()),
                 nearest.begin(), [](const auto& other) { return other.second; });
  return nearest;
}

NeighborLists findNearestNeighbors(const Positions& points, int count, const Execution& execution) {
  internal::checkThreads(execution.threads);
  return points.cols() == 0 ? NeighborLists()
                            : searchAll(makeNeighborSearch(points, execution),
                                        static_cast<std::size_t>(points.cols()), count);
}

}  // namespace spherical_param
