#include "search/kd_tree.h"

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>

namespace pcl {
namespace detail {

namespace {

/// Queries that one thread has answered at a time, with the same scratch memory.
constexpr std::size_t queries_at_a_time = 512;

}  // namespace

struct KdTreeSearch::Tree : spherical_param::internal::KdTree<float> {
  using KdTree::KdTree;
};

KdTreeSearch::KdTreeSearch(const spherical_param::Positions& points)
    : tree_(std::make_shared<Tree>(points)) {}

spherical_param::NeighborLists
KdTreeSearch::findNeighbors(const std::vector<spherical_param::Index>& points, int neighbors,
                            int threads, const std::function<void(double)>& report) const {
  spherical_param::NeighborLists lists = listsOfOneLength(points.size(), neighbors, tree_->size());
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
