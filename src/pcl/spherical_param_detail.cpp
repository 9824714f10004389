// What of SphericalParamReconstruction does not depend on the type of the points.

#include "kd_tree.h"

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>
#include <pcl/surface/spherical_param_map.h>

#include "spherical_param/errors.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <mutex>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace pcl {
namespace detail {

namespace {

using spherical_param::Index;
using spherical_param::InvalidInput;

/// Carries an exception of the user's progress callback past the handlers that turn exceptions into
/// error messages; therefore not a std::exception.
struct ProgressCallbackFailure {
  std::exception_ptr cause;
};

/// Keeps a message in words that need no memory, if there is none for the message.
void setMessage(std::string& message, const char* text) noexcept {
  try {
    message = text;
  } catch (...) {
    message = "out of memory";
  }
}

/// Calls query(i, indices, distances) for i in [0, count), the last two being scratch memory of the
/// thread, and report(fraction) from the calling thread after each of some blocks, the last time
/// with 1.
///
/// \param blocks  at least 1; with several threads each waits for the others at its end
/// \param threads above 1, query is called concurrently. Its exceptions are passed on.
template <typename Query>
void queryInBlocks(std::size_t count, std::size_t blocks, [[maybe_unused]] int threads,
                   const Query& query, const std::function<void(double)>& report) {
  blocks = std::min(count, blocks);
  std::exception_ptr error;
  std::mutex error_mutex;
  for (std::size_t block = 0; block < blocks; ++block) {
    const auto begin = static_cast<std::int64_t>(count * block / blocks);
    const auto end = static_cast<std::int64_t>(count * (block + 1) / blocks);
#ifdef _OPENMP
#pragma omp parallel num_threads(threads) if (threads > 1)
#endif
    {
      pcl::Indices indices;
      std::vector<float> distances;
#ifdef _OPENMP
#pragma omp for schedule(guided)
#endif
      for (std::int64_t i = begin; i < end; ++i) {
        try {
          query(static_cast<std::size_t>(i), indices, distances);
        } catch (...) {
          const std::lock_guard<std::mutex> lock(error_mutex);
          error = std::current_exception();
        }
      }
    }
    if (error)
      std::rethrow_exception(error);
    report(static_cast<double>(block + 1) / static_cast<double>(blocks));
  }
}

/// Threads for `queries` queries if `threads` are asked for (0: as many as OpenMP would use); 1
/// without OpenMP or where starting threads takes longer than they save.
int searchThreads([[maybe_unused]] int threads, [[maybe_unused]] std::size_t queries) {
#ifdef _OPENMP
  constexpr std::size_t fewest_parallel_queries = 5000;
  if (threads >= 0 && queries >= fewest_parallel_queries)
    // The runtime ends the process if it cannot start the threads it is asked for.
    return std::min(threads > 0 ? threads : omp_get_max_threads(), 4 * omp_get_num_procs());
#endif
  return 1;
}

/// Room for the neighbours of `queries` points among `points`, each besides itself.
spherical_param::NeighborLists listsOfOneLength(std::size_t queries, int neighbors,
                                                std::size_t points) {
  // One more, since a point is its own neighbour.
  const std::size_t list_size =
      std::min(static_cast<std::size_t>(std::max(neighbors, 0)), points - 1) + 1;
  spherical_param::NeighborLists lists;
  lists.offsets.resize(queries + 1);
  for (std::size_t i = 0; i < lists.offsets.size(); ++i)
    lists.offsets[i] = i * list_size;
  lists.indices.resize(queries * list_size);
  return lists;
}

/// Finds the nearest neighbours of each point, besides itself, one point after the other.
spherical_param::NeighborLists findNeighbors(const NeighborSource& source,
                                             const std::vector<Index>& points, int neighbors,
                                             const std::function<void(double)>& report) {
  spherical_param::NeighborLists lists = listsOfOneLength(points.size(), neighbors, source.size);
  constexpr std::size_t reports = 32;
  // A search object of the user need not be ready for concurrent queries.
  constexpr int threads = 1;
  queryInBlocks(
      points.size(), reports, threads,
      [&](std::size_t i, pcl::Indices& indices, std::vector<float>& distances) {
        source.query(points[i], lists.offsets[i + 1] - lists.offsets[i], indices, distances,
                     lists.indices.data() + lists.offsets[i]);
      },
      report);
  return lists;
}

}  // namespace

const char* withoutFunctionName(const char* message) {
  const char* end = message;
  while (std::isalnum(static_cast<unsigned char>(*end)) != 0)
    ++end;
  return end > message && end[0] == ':' && end[1] == ' ' ? end + 2 : message;
}

std::string failureOf(const std::function<void()>& work, std::exception_ptr& callback_error) {
  std::string failure;
  try {
    work();
  } catch (const ProgressCallbackFailure& error) {
    callback_error = error.cause;
    setMessage(failure, "the progress callback threw an exception");
  } catch (const std::bad_alloc&) {
    setMessage(failure,
               "out of memory; mesh a subset of the points (setIndices) or lower k (setKSearch)");
  } catch (const std::exception& error) {
    setMessage(failure, withoutFunctionName(error.what()));
    if (failure.empty())
      setMessage(failure, "an exception without a message");
  } catch (...) {
    setMessage(failure, "an unknown exception, probably of the search object");
  }
  return failure;
}

void checkCloud(std::size_t points, std::size_t width, std::size_t height) {
  if (points == 0)
    throw InvalidInput("the input cloud is empty; at least 4 points are needed");
  // PCL allows both to be 0 for "not organized".
  if ((width != 0 || height != 0) && width * height != points)
    throw InvalidInput("the input cloud has " + std::to_string(points) +
                       " points, but its width is " + std::to_string(width) + " and its height " +
                       std::to_string(height) +
                       "; set width to the number of points and height to 1");
}

void refuseIndex(std::size_t entry, pcl::index_t index, std::size_t points) {
  throw InvalidInput("entry " + std::to_string(entry) + " of the indices is " +
                     std::to_string(index) + ", but the cloud has " + std::to_string(points) +
                     " points; indices must be from 0 to the number of points less one");
}

pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOfVertices(const spherical_param::Positions& vertices,
                                                    const std::vector<Index>& vertex_of_used,
                                                    const pcl::Indices& used_points,
                                                    std::size_t points) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->resize(points);
  std::fill(cloud->begin(), cloud->end(), pcl::PointXYZ(nan, nan, nan));
  cloud->is_dense = used_points.size() == points;
  for (std::size_t i = 0; i < used_points.size(); ++i)
    (*cloud)[static_cast<std::size_t>(used_points[i])].getVector3fMap() =
        vertices.col(vertex_of_used[i]).cast<float>();
  return cloud;
}

std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles,
                                      const pcl::Indices& point_of_vertex) {
  std::vector<pcl::Vertices> polygons(static_cast<std::size_t>(triangles.cols()));
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const auto triangle = triangles.col(static_cast<Eigen::Index>(t));
    polygons[t].vertices = {point_of_vertex[static_cast<std::size_t>(triangle[0])],
                            point_of_vertex[static_cast<std::size_t>(triangle[1])],
                            point_of_vertex[static_cast<std::size_t>(triangle[2])]};
  }
  return polygons;
}

spherical_param::Result reconstructPoints(
    const spherical_param::Positions& points, spherical_param::Options options,
    std::size_t ignored_points,
    const std::function<NeighborSource(const std::vector<Index>&)>& use_search_method) {
  std::exception_ptr callback_error;
  if (options.progress) {
    options.progress = [callback = std::move(options.progress),
                        &callback_error](const spherical_param::Progress& progress) {
      try {
        return !callback_error && callback(progress);
      } catch (...) {
        callback_error = std::current_exception();
        return false;
      }
    };
  }
  const auto report = [&options](double fraction) {
    // The end of the stage is told by the core.
    const double share = spherical_param::kShareBeforeSearch +
                         (1.0 - spherical_param::kShareBeforeSearch) * fraction;
    if (fraction < 1.0 && options.progress && !options.progress({"neighbors", share, 0, 0.0}))
      throw spherical_param::Cancelled("cancelled by the progress callback");
  };
  const auto make_search =
      [&](const spherical_param::Positions& distinct,
          const std::vector<Index>& point_of_distinct) -> spherical_param::NeighborSearch {
    std::function<spherical_param::NeighborLists(const std::vector<Index>&, int,
                                                 const std::function<void(double)>&)>
        find;
    if (use_search_method)
      find = [source = use_search_method(point_of_distinct)](const auto& some_points, int neighbors,
                                                             const auto& report_share) {
        return findNeighbors(source, some_points, neighbors, report_share);
      };
    else
      find = [tree = KdTreeSearch(distinct), &options](const auto& some_points, int neighbors,
                                                       const auto& report_share) {
        return tree.findNeighbors(some_points, neighbors, options.threads, report_share);
      };
    return [find, report, is_first = true](const std::vector<Index>& some_points,
                                           int neighbors) mutable {
      // The progress is that of the search for all points; others belong to the graph.
      if (std::exchange(is_first, false))
        return find(some_points, neighbors, report);
      return find(some_points, neighbors, [](double) {});
    };
  };

  spherical_param::Result result;
  try {
    result = spherical_param::reconstruct(points, make_search, options);
  } catch (const InvalidInput& error) {
    if (!callback_error && ignored_points == 0)
      throw;
    if (!callback_error)
      throw InvalidInput(std::string(error.what()) + " (of the cloud's points, " +
                         std::to_string(ignored_points) + " are not finite)");
  } catch (...) {
    if (!callback_error)
      throw;
  }
  if (callback_error)
    throw ProgressCallbackFailure{callback_error};
  return result;
}

struct KdTreeSearch::Tree : spherical_param::internal::KdTree<float> {
  using KdTree::KdTree;
};

KdTreeSearch::KdTreeSearch(const spherical_param::Positions& points)
    : tree_(std::make_shared<Tree>(points)) {}

spherical_param::NeighborLists
KdTreeSearch::findNeighbors(const std::vector<Index>& points, int neighbors, int threads,
                            const std::function<void(double)>& report) const {
  // Queries that one thread has answered at a time, with the same scratch memory.
  constexpr std::size_t queries_at_a_time = 512;
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
