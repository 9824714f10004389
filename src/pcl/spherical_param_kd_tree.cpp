#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/matrix.h>
#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

namespace pcl {
namespace detail {

namespace {

/// Squared distance in space. With a distance of our own the tree is none of those in PCL's
/// libraries, which open a parallel region in each query and would take the place of ours.
struct SquaredDistance {
  using is_kdtree_distance = bool;
  using ElementType = float;
  using ResultType = float;

  template <typename A, typename B>
  float operator()(A a, B b, std::size_t /*dimensions*/, float /*worst*/ = -1.0F) const {
    const float x = a[0] - b[0];
    const float y = a[1] - b[1];
    const float z = a[2] - b[2];
    return x * x + y * y + z * z;
  }
  float accum_dist(float a, float b, int /*axis*/) const { return (a - b) * (a - b); }
};

/// Queries that one thread has answered at a time: FLANN opens a parallel region for each call,
/// which takes longer than a query.
constexpr std::size_t queries_at_a_time = 512;

}  // namespace

struct KdTreeSearch::Tree {
  explicit Tree(const spherical_param::Positions& points)
      : coordinates(points.cast<float>()),
        index(flann::Matrix<float>(coordinates.data(), static_cast<std::size_t>(points.cols()), 3),
              flann::KDTreeSingleIndexParams(leaf_size)) {
    index.buildIndex();
  }

  /// Writes the nearest points of the queries, `neighbors` for each, as positions in the tree.
  void find(const spherical_param::Index* queries, std::size_t count, std::size_t neighbors,
            spherical_param::Index* found) const {
    std::vector<float> of_queries(3 * count);
    for (std::size_t i = 0; i < count; ++i)
      Eigen::Vector3f::Map(of_queries.data() + 3 * i) = coordinates.col(queries[i]);
    std::vector<float> distances(neighbors * count);
    flann::Matrix<int> rows(found, count, neighbors);
    flann::Matrix<float> distance_rows(distances.data(), count, neighbors);
    flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
    parameters.cores = 1;
    parameters.use_heap = flann::FLANN_False;
    index.knnSearch(flann::Matrix<float>(of_queries.data(), count, 3), rows, distance_rows,
                    neighbors, parameters);
  }

  static constexpr int leaf_size = 15;  ///< as in PCL

  Eigen::Matrix<float, 3, Eigen::Dynamic> coordinates;
  flann::KDTreeSingleIndex<SquaredDistance> index;
};

KdTreeSearch::KdTreeSearch(const spherical_param::Positions& points)
    : tree_(std::make_shared<Tree>(points)) {}

spherical_param::NeighborLists
KdTreeSearch::findNeighbors(const std::vector<spherical_param::Index>& points, int neighbors,
                            int threads, const std::function<void(double)>& report) const {
  spherical_param::NeighborLists lists = listsOfOneLength(
      points.size(), neighbors, static_cast<std::size_t>(tree_->coordinates.cols()));
  const std::size_t list_size = points.empty() ? 0 : lists.offsets[1];
  const std::size_t batches = (points.size() + queries_at_a_time - 1) / queries_at_a_time;
  // Some tenths of a second each.
  constexpr std::size_t batches_of_a_block = 512;
  queryInBlocks(
      batches, batches / batches_of_a_block + 2, searchThreads(threads, points.size()),
      [&](std::size_t batch, pcl::Indices&, std::vector<float>&) {
        const std::size_t begin = batch * queries_at_a_time;
        tree_->find(points.data() + begin, std::min(queries_at_a_time, points.size() - begin),
                    list_size, lists.indices.data() + begin * list_size);
      },
      report);
  return lists;
}

}  // namespace detail
}  // namespace pcl
