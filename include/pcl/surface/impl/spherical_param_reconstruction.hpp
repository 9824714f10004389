#pragma once

#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/search/organized.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <utility>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace pcl {
namespace detail {

/** \brief Carries an exception of the user's progress callback past the handlers that turn
 * exceptions into error messages; therefore not a std::exception. */
struct ProgressCallbackFailure {
  std::exception_ptr cause;
};

/** \brief The core's messages begin with the name of the function; ours has its own. */
inline const char* withoutFunctionName(const char* message) {
  const char* end = message;
  while (std::isalnum(static_cast<unsigned char>(*end)) != 0)
    ++end;
  return end > message && end[0] == ':' && end[1] == ' ' ? end + 2 : message;
}

/** \brief Keeps a message in words that need no memory, if there is none for the message. */
inline void setMessage(std::string& message, const char* text) noexcept {
  try {
    message = text;
  } catch (...) {
    message = "out of memory";
  }
}

/** \brief Gives an output the header of the cloud, if it has one. */
inline void setHeader(pcl::PolygonMesh& output, const pcl::PCLHeader& header) {
  output.header = header;
}
template <typename Output>
void setHeader(Output& /*output*/, const pcl::PCLHeader& /*header*/) {}

/** \brief Which numbers a search object returns that was filled with a subset of a cloud: PCL 1.13
 * has both, e.g. KdTree the one and FlannSearch the other. */
enum class SearchIndexSpace { Cloud, Subset };

/** \brief Calls query(i, indices, distances) for i in [0, count), the last two being scratch memory
 * of the thread, and report(fraction) from the calling thread after each of some blocks, the last
 * time with 1.
 * \param[in] blocks at least 1; with several threads each waits for the others at its end
 * \param[in] threads above 1, query is called concurrently. Its exceptions are passed on. */
template <typename Query, typename Report>
void queryInBlocks(std::size_t count, std::size_t blocks, [[maybe_unused]] int threads,
                   const Query& query, const Report& report) {
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

/** \brief Threads for `queries` queries if `threads` are asked for (0: as many as OpenMP would
 * use); 1 without OpenMP or where starting threads takes longer than they save. */
inline int searchThreads([[maybe_unused]] int threads, [[maybe_unused]] std::size_t queries) {
#ifdef _OPENMP
  constexpr std::size_t fewest_parallel_queries = 5000;
  if (threads >= 0 && queries >= fewest_parallel_queries)
    // The runtime ends the process if it cannot start the threads it is asked for.
    return std::min(threads > 0 ? threads : omp_get_max_threads(), 4 * omp_get_num_procs());
#endif
  return 1;
}

/** \brief Finds all neighbours of a set of points; it is searched once more for some of them. */
struct NeighborSource {
  std::size_t size = 0;  ///< number of points that can be found
  /** \brief Writes `count` (at most size) neighbours of a point to `neighbors`, the point itself
   * among them, all as positions in the indices used. The two vectors are scratch memory. */
  std::function<void(spherical_param::Index point, std::size_t count, pcl::Indices& indices,
                     std::vector<float>& distances, spherical_param::Index* neighbors)>
      query;
};

/** \brief Room for the neighbours of `queries` points among `points`, each besides itself. */
inline spherical_param::NeighborLists listsOfOneLength(std::size_t queries, int neighbors,
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

/** \brief Finds the nearest neighbours of each point, besides itself, one point after the other. */
template <typename Report>
spherical_param::NeighborLists findNeighbors(const NeighborSource& source,
                                             const std::vector<spherical_param::Index>& points,
                                             int neighbors, const Report& report) {
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

/** \brief FLANN's k-d tree of some points, which answers many queries at a time. That of
 * pcl::search::KdTree is the same, but opens a parallel region for each query, which takes as long
 * as the query. Copies share the tree. */
class PCL_EXPORTS KdTreeSearch {
public:
  /** \param[in] points distinct, of an extent of about 1: squared distances in float underflow for
   * small clouds and overflow for large ones. Those that are near should be near in memory. */
  explicit KdTreeSearch(const spherical_param::Positions& points);

  /** \brief Finds the nearest neighbours of each point, besides itself.
   * \param[in] threads OpenMP threads; 0: as many as OpenMP would use
   * \param[in] report called from this thread with the share that is done */
  spherical_param::NeighborLists findNeighbors(const std::vector<spherical_param::Index>& points,
                                               int neighbors, int threads,
                                               const std::function<void(double)>& report) const;

private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
};

/** \brief Finds out which numbers `search` returns for a subset. Points are told apart by asking
 * for the one neighbour of a point of the subset, which is the point itself. */
template <typename PointInT>
SearchIndexSpace findSearchIndexSpace(const pcl::search::Search<PointInT>& search,
                                      const pcl::PointCloud<PointInT>& cloud,
                                      const pcl::Indices& subset) {
  // An approximate search may miss a few, but not a thousand times.
  int probes_left = 1000;
  pcl::Indices found;
  std::vector<float> distances;
  for (std::size_t i = 0; i < subset.size() && probes_left > 0; ++i) {
    const auto position = static_cast<pcl::index_t>(i);
    if (subset[i] == position)
      continue;
    --probes_left;
    if (search.nearestKSearch(cloud[static_cast<std::size_t>(subset[i])], 1, found, distances) < 1)
      continue;
    if (found.at(0) == subset[i])
      return SearchIndexSpace::Cloud;
    if (found.at(0) == position)
      return SearchIndexSpace::Subset;
  }
  throw spherical_param::ComputeError(
      "the search object does not find the points it was given; use a pcl::search::KdTree");
}

/** \brief Gives access to the camera model of an OrganizedNeighbor. Its own projectPoint() needs
 * members that a custom point type need not have. */
template <typename PointInT>
struct OrganizedCamera : public pcl::search::OrganizedNeighbor<PointInT> {
  /** \brief Get the homogeneous pixel coordinates of a point. */
  static Eigen::Vector3f project(const pcl::search::OrganizedNeighbor<PointInT>& search,
                                 const Eigen::Vector3f& point) {
    return search.*(&OrganizedCamera::KR_) * point +
           (search.*(&OrganizedCamera::projection_matrix_)).col(3);
  }
};

/** \brief Refuses a camera model of an OrganizedNeighbor that does not hold for the cloud, with
 * which it would find few or wrong neighbours, or not return.
 * \param[in] points indices into the cloud */
template <typename PointInT>
void checkCameraModel(const pcl::search::OrganizedNeighbor<PointInT>& search,
                      const pcl::PointCloud<PointInT>& cloud, const pcl::Indices& points) {
  // The search starts at the pixel that a point is projected to and looks at larger and larger
  // squares, hence a small error does no harm.
  const float tolerance = 0.05F * static_cast<float>(std::max(cloud.width, cloud.height));
  for (const pcl::index_t index : points) {
    const PointInT& point = cloud[static_cast<std::size_t>(index)];
    const Eigen::Vector2f pixel =
        OrganizedCamera<PointInT>::project(search, Eigen::Vector3f(static_cast<float>(point.x),
                                                                   static_cast<float>(point.y),
                                                                   static_cast<float>(point.z)))
            .hnormalized();
    const auto row = static_cast<pcl::uindex_t>(index) / cloud.width;
    const auto column = static_cast<pcl::uindex_t>(index) % cloud.width;
    // Written so that NaN fails.
    if (!(std::abs(pixel.x() - static_cast<float>(column)) <= tolerance &&
          std::abs(pixel.y() - static_cast<float>(row)) <= tolerance))
      throw spherical_param::InvalidInput(
          "the search object is an OrganizedNeighbor, but the cloud is not the depth image of a "
          "pinhole camera; use a pcl::search::KdTree");
  }
}

}  // namespace detail

template <typename PointInT>
SphericalParamReconstruction<PointInT>::SphericalParamReconstruction() {
  // The base class would give all points to the search, those that are not finite included.
  check_tree_ = false;
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct(pcl::PolygonMesh& output) {
  run(output);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct(std::vector<pcl::Vertices>& polygons) {
  run(polygons);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct() {
  NoOutput none;
  run(none);
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::getSphereCoordinates() const {
  return cloudOfVertices(result_.sphere);
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::getSmoothedPoints() const {
  if (result_.smoothed.cols() == 0)
    return pcl::PointCloud<pcl::PointXYZ>::Ptr(new pcl::PointCloud<pcl::PointXYZ>);
  return cloudOfVertices(result_.smoothed);
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr SphericalParamReconstruction<PointInT>::cloudOfVertices(
    const spherical_param::Positions& vertices) const {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->resize(input_size_);
  std::fill(cloud->begin(), cloud->end(), pcl::PointXYZ(nan, nan, nan));
  cloud->is_dense = used_indices_.size() == input_size_;
  for (std::size_t i = 0; i < used_indices_.size(); ++i)
    (*cloud)[static_cast<std::size_t>(used_indices_[i])].getVector3fMap() =
        vertices.col(result_.vertex_of_input[i]).template cast<float>();
  return cloud;
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(pcl::PolygonMesh& output) {
  performReconstruction(output.polygons);
  pcl::toPCLPointCloud2(*input_, output.cloud);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(
    std::vector<pcl::Vertices>& polygons) {
  NoOutput none;
  performReconstruction(none);
  polygons.resize(static_cast<std::size_t>(result_.triangles.cols()));
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const auto triangle = result_.triangles.col(static_cast<Eigen::Index>(t));
    polygons[t].vertices = {vertex_indices_[static_cast<std::size_t>(triangle[0])],
                            vertex_indices_[static_cast<std::size_t>(triangle[1])],
                            vertex_indices_[static_cast<std::size_t>(triangle[2])]};
  }
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(NoOutput& /*none*/) {
  // A copy, so that the callback may call the setters.
  spherical_param::Options options = options_;
  std::exception_ptr callback_error;
  if (options_.progress) {
    options.progress = [callback = options_.progress,
                        &callback_error](const spherical_param::Progress& progress) {
      try {
        return !callback_error && callback(progress);
      } catch (...) {
        callback_error = std::current_exception();
        return false;
      }
    };
  }

  try {
    result_ = reconstructPoints(collectPoints(), options);
  } catch (...) {
    if (!callback_error)
      throw;
  }
  if (callback_error)
    throw detail::ProgressCallbackFailure{callback_error};

  vertex_indices_.reserve(result_.input_of_vertex.size());
  for (const spherical_param::Index point : result_.input_of_vertex)
    vertex_indices_.push_back(used_indices_[static_cast<std::size_t>(point)]);
  input_size_ = input_->size();
}

template <typename PointInT>
template <typename Output>
void SphericalParamReconstruction<PointInT>::run(Output& output) {
  output = Output();
  clearResults();
  std::string failure;
  std::exception_ptr callback_error;
  bool initialized = false;
  try {
    checkInput();
    initialized = initCompute();
    // initCompute() ignores that it had no memory for the indices.
    if (!initialized || (fake_indices_ && indices_->size() != input_->size()))
      throw std::bad_alloc();
    performReconstruction(output);
    detail::setHeader(output, input_->header);
  } catch (const detail::ProgressCallbackFailure& error) {
    callback_error = error.cause;
    detail::setMessage(failure, "the progress callback threw an exception");
  } catch (const std::bad_alloc&) {
    detail::setMessage(
        failure, "out of memory; mesh a subset of the points (setIndices) or lower k (setKSearch)");
  } catch (const std::exception& error) {
    detail::setMessage(failure, detail::withoutFunctionName(error.what()));
    if (failure.empty())
      detail::setMessage(failure, "an exception without a message");
  } catch (...) {
    detail::setMessage(failure, "an unknown exception, probably of the search object");
  }
  if (initialized)
    deinitCompute();
  // Copies of this object would share the indices that initCompute() made, across threads as well.
  if (fake_indices_)
    indices_.reset();
  if (failure.empty())
    return;

  output = Output();
  clearResults();
  try {
    if (input_)
      detail::setHeader(output, input_->header);
  } catch (const std::bad_alloc&) {
    // There is a failure to be told already.
  }
  error_message_ = std::move(failure);
  if (callback_error)
    std::rethrow_exception(callback_error);
  try {
    PCL_ERROR("[pcl::%s::reconstruct] %s\n", getClassName().c_str(), error_message_.c_str());
  } catch (const std::bad_alloc&) {
    // Not even for the name of the class.
    PCL_ERROR("[pcl::SphericalParamReconstruction::reconstruct] %s\n", error_message_.c_str());
  }
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::clearResults() {
  result_ = spherical_param::Result();
  // Unlike clear(), this gives the memory back.
  used_indices_ = pcl::Indices();
  vertex_indices_ = pcl::Indices();
  input_size_ = 0;
  ignored_points_ = 0;
  error_message_.clear();
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::checkInput() const {
  if (!input_)
    throw spherical_param::InvalidInput("there is no input cloud; call setInputCloud() first");
  if (input_->empty())
    throw spherical_param::InvalidInput("the input cloud is empty; at least 4 points are needed");
  const std::size_t width = input_->width;
  const std::size_t height = input_->height;
  // PCL allows both to be 0 for "not organized".
  if ((width != 0 || height != 0) && width * height != input_->size())
    throw spherical_param::InvalidInput("the input cloud has " + std::to_string(input_->size()) +
                                        " points, but its width is " + std::to_string(width) +
                                        " and its height " + std::to_string(height) +
                                        "; set width to the number of points and height to 1");
  if (indices_ && !fake_indices_ && indices_->empty())
    throw spherical_param::InvalidInput(
        "the indices are empty; set at least 4, or none (a null pointer) to mesh all points");
}

template <typename PointInT>
spherical_param::Positions SphericalParamReconstruction<PointInT>::collectPoints() {
  std::vector<bool> seen(input_->size(), false);
  used_indices_.reserve(indices_->size());
  for (std::size_t i = 0; i < indices_->size(); ++i) {
    const pcl::index_t index = (*indices_)[i];
    if (index < 0 || static_cast<std::size_t>(index) >= input_->size())
      throw spherical_param::InvalidInput(
          "entry " + std::to_string(i) + " of the indices is " + std::to_string(index) +
          ", but the cloud has " + std::to_string(input_->size()) +
          " points; indices must be from 0 to the number of points less one");
    const auto position = static_cast<std::size_t>(index);
    if (seen[position])
      continue;
    seen[position] = true;
    const PointInT& point = (*input_)[position];
    if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z))
      used_indices_.push_back(index);
    else
      ++ignored_points_;
  }
  used_indices_.shrink_to_fit();

  spherical_param::Positions points(3, static_cast<Eigen::Index>(used_indices_.size()));
  for (std::size_t i = 0; i < used_indices_.size(); ++i) {
    const PointInT& point = (*input_)[static_cast<std::size_t>(used_indices_[i])];
    points.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(
        static_cast<double>(point.x), static_cast<double>(point.y), static_cast<double>(point.z));
  }
  return points;
}

template <typename PointInT>
spherical_param::Result SphericalParamReconstruction<PointInT>::reconstructPoints(
    const spherical_param::Positions& points, const spherical_param::Options& options) const {
  const auto report = [&options](double fraction) {
    // The end of the stage is told by the core.
    const double share = spherical_param::kShareBeforeSearch +
                         (1.0 - spherical_param::kShareBeforeSearch) * fraction;
    if (fraction < 1.0 && options.progress && !options.progress({"neighbors", share, 0, 0.0}))
      throw spherical_param::Cancelled("cancelled by the progress callback");
  };
  const auto make_search = [&](const spherical_param::Positions& distinct,
                               const std::vector<spherical_param::Index>& point_of_distinct)
      -> spherical_param::NeighborSearch {
    std::function<spherical_param::NeighborLists(const std::vector<spherical_param::Index>&, int,
                                                 const std::function<void(double)>&)>
        find;
    if (tree_)
      find = [source = useSearchMethod(point_of_distinct)](const auto& some_points, int neighbors,
                                                           const auto& report_share) {
        return detail::findNeighbors(source, some_points, neighbors, report_share);
      };
    else
      find = [tree = detail::KdTreeSearch(distinct),
              &options](const auto& some_points, int neighbors, const auto& report_share) {
        return tree.findNeighbors(some_points, neighbors, options.threads, report_share);
      };
    return [find, report, is_first = true](const std::vector<spherical_param::Index>& some_points,
                                           int neighbors) mutable {
      // The progress is that of the search for all points; others belong to the graph.
      if (std::exchange(is_first, false))
        return find(some_points, neighbors, report);
      return find(some_points, neighbors, [](double) {});
    };
  };
  try {
    return spherical_param::reconstruct(points, make_search, options);
  } catch (const spherical_param::InvalidInput& error) {
    if (ignored_points_ == 0)
      throw;
    throw spherical_param::InvalidInput(std::string(error.what()) + " (of the cloud's points, " +
                                        std::to_string(ignored_points_) + " are not finite)");
  }
}

template <typename PointInT>
detail::NeighborSource SphericalParamReconstruction<PointInT>::useSearchMethod(
    const std::vector<spherical_param::Index>& point_of_distinct) const {
  const auto* organized =
      dynamic_cast<const pcl::search::OrganizedNeighbor<PointInT>*>(tree_.get());
  if (organized && (input_->height <= 1 || input_->width <= 1))
    throw spherical_param::InvalidInput(
        "the search object is an OrganizedNeighbor, but the cloud is not organized; use a "
        "pcl::search::KdTree");

  std::vector<pcl::index_t> cloud_of_distinct(point_of_distinct.size());
  std::vector<spherical_param::Index> distinct_of_cloud(input_->size(), -1);
  for (std::size_t i = 0; i < point_of_distinct.size(); ++i) {
    cloud_of_distinct[i] = used_indices_[static_cast<std::size_t>(point_of_distinct[i])];
    distinct_of_cloud[static_cast<std::size_t>(cloud_of_distinct[i])] =
        static_cast<spherical_param::Index>(i);
  }
  // The search is given the points in the order of the indices used.
  std::vector<spherical_param::Index> points = point_of_distinct;
  std::sort(points.begin(), points.end());
  pcl::IndicesPtr subset(new pcl::Indices);
  subset->reserve(points.size());
  for (const spherical_param::Index point : points)
    subset->push_back(used_indices_[static_cast<std::size_t>(point)]);
  tree_->setInputCloud(input_, subset);
  if (organized)
    detail::checkCameraModel(*organized, *input_, *subset);
  const bool whole_in_order =
      std::is_sorted(subset->begin(), subset->end()) && subset->size() == input_->size();
  std::vector<spherical_param::Index> distinct_of_answer;
  if (whole_in_order ||
      detail::findSearchIndexSpace(*tree_, *input_, *subset) == detail::SearchIndexSpace::Cloud) {
    distinct_of_answer = std::move(distinct_of_cloud);
  } else {
    distinct_of_answer.reserve(subset->size());
    for (const pcl::index_t index : *subset)
      distinct_of_answer.push_back(distinct_of_cloud[static_cast<std::size_t>(index)]);
  }

  detail::NeighborSource source;
  source.size = point_of_distinct.size();
  source.query = [this, cloud_of_distinct = std::move(cloud_of_distinct),
                  distinct_of_answer = std::move(distinct_of_answer)](
                     spherical_param::Index point, std::size_t count, pcl::Indices& indices,
                     std::vector<float>& distances, spherical_param::Index* neighbors) {
    const pcl::index_t index = cloud_of_distinct[static_cast<std::size_t>(point)];
    const int answers = tree_->nearestKSearch((*input_)[static_cast<std::size_t>(index)],
                                              static_cast<int>(count), indices, distances);
    const std::size_t found =
        std::min({static_cast<std::size_t>(std::max(answers, 0)), indices.size(), count});
    for (std::size_t i = 0; i < found; ++i) {
      const auto answer = static_cast<std::size_t>(indices[i]);
      if (answer >= distinct_of_answer.size() || distinct_of_answer[answer] < 0)
        throw spherical_param::ComputeError(
            "the search object returned index " + std::to_string(indices[i]) +
            ", which is not among the points it was given; use a pcl::search::KdTree");
      neighbors[i] = distinct_of_answer[answer];
    }
    // A search that finds fewer is made up for by the point itself, which the core ignores.
    std::fill(neighbors + found, neighbors + count, point);
  };
  return source;
}

}  // namespace pcl

#define PCL_INSTANTIATE_SphericalParamReconstruction(T)                                            \
  template class PCL_EXPORTS pcl::SphericalParamReconstruction<T>;
