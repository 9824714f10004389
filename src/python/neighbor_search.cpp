#include "python/neighbor_search.h"

#include "parallel.h"
#include "search/kd_tree.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>

namespace spherical_param::python {
namespace {

using Tree = internal::KdTree<double>;

NeighborLists search(const Tree& tree, const std::vector<Index>& points, int neighbors, int threads,
                     const internal::ShareReport& report) {
  // One more, since a point is its own neighbour.
  const std::size_t list_size =
      std::min(static_cast<std::size_t>(std::max(neighbors, 0)), tree.size() - 1) + 1;
  NeighborLists lists;
  lists.offsets.resize(points.size() + 1);
  for (std::size_t i = 0; i < lists.offsets.size(); ++i)
    lists.offsets[i] = i * list_size;
  lists.indices.resize(points.size() * list_size);
  std::exception_ptr error;
  std::mutex error_mutex;
  const int workers = internal::threadCount(threads, points.size(), internal::kParallelThreshold);
  internal::forEachBlock(points.size(), workers, report,
                         [&](std::size_t, std::size_t begin, std::size_t end) {
                           try {
                             tree.find(points.data() + begin, end - begin, list_size,
                                       lists.indices.data() + begin * list_size);
                           } catch (...) {
                             const std::lock_guard<std::mutex> lock(error_mutex);
                             error = std::current_exception();
                           }
                         });
  if (error)
    std::rethrow_exception(error);
  return lists;
}

}  // namespace

NeighborSearchFactory neighborSearch(int threads, const std::function<void(double)>& report) {
  return [threads, report](const Positions& points, const std::vector<Index>&) -> NeighborSearch {
    return [tree = std::make_shared<const Tree>(points), threads, report,
            is_first = true](const std::vector<Index>& queries, int count) mutable {
      // What is told is the search for all points; others belong to the graph.
      const bool is_told = std::exchange(is_first, false);
      return search(*tree, queries, count, threads, is_told ? report : nullptr);
    };
  };
}

NeighborLists nearestNeighbors(const Positions& points, int count, int threads,
                               const std::function<void(double)>& report) {
  const Tree tree(points);
  std::vector<Index> all(static_cast<std::size_t>(points.cols()));
  std::iota(all.begin(), all.end(), Index{0});
  return search(tree, all, count, threads, report);
}

}  // namespace spherical_param::python
