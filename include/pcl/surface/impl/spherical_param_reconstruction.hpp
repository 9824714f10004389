#pragma once

#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/search/organized.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace pcl {
namespace detail {

/** \brief Calls the work of a reconstruction, which may throw anything.
 * \param[out] callback_error what the progress callback threw, if it did
 * \return why it failed, with a remedy; empty after a success */
PCL_EXPORTS std::string failureOf(const std::function<void()>& work,
                                  std::exception_ptr& callback_error);

/** \brief Throws InvalidInput for a cloud without points, or with a width and a height of another
 * number of points. */
PCL_EXPORTS void checkCloud(std::size_t points, std::size_t width, std::size_t height);

/** \brief Throws InvalidInput for an entry of the indices that is out of range. */
[[noreturn]] PCL_EXPORTS void refuseIndex(std::size_t entry, pcl::index_t index,
                                          std::size_t points);

/** \brief Makes a cloud from the positions of vertices, 3 x v; NaN where a point is no
 * vertex.
 * \param[in] vertex_of_used the vertex of each of the used points */
PCL_EXPORTS pcl::PointCloud<pcl::PointXYZ>::Ptr
cloudOfVertices(const spherical_param::Positions& vertices,
                const std::vector<spherical_param::Index>& vertex_of_used,
                const pcl::Indices& used_points, std::size_t points);

/** \brief Triangles of vertices as polygons of points. */
PCL_EXPORTS std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles,
                                                  const pcl::Indices& point_of_vertex);

/** \brief Which numbers a search object returns that was filled with a subset of a cloud: PCL 1.13
 * has both, e.g. KdTree the one and FlannSearch the other. */
enum class SearchIndexSpace { Cloud, Subset };

/** \brief Finds all neighbours of a set of points; it is searched once more for some of them. */
struct NeighborSource {
  std::size_t size = 0;  ///< number of points that can be found
  /** \brief Writes `count` (at most size) neighbours of a point to `neighbors`, the point itself
   * among them, all as positions in the indices used. The two vectors are scratch memory. */
  std::function<void(spherical_param::Index point, std::size_t count, pcl::Indices& indices,
                     std::vector<float>& distances, spherical_param::Index* neighbors)>
      query;
};

/** \brief Meshes points with the core.
 * \param[in] options their progress callback may throw
 * \param[in] ignored_points points of the cloud that are not finite, for messages
 * \param[in] use_search_method passes the distinct points to the user's search object; its argument
 * is the first input point of each; empty: a k-d tree of our own is used */
PCL_EXPORTS spherical_param::Result
reconstructPoints(const spherical_param::Positions& points, spherical_param::Options options,
                  std::size_t ignored_points,
                  const std::function<NeighborSource(const std::vector<spherical_param::Index>&)>&
                      use_search_method);

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
  output = pcl::PolygonMesh();
  const auto work = [&] {
    performReconstruction(output);
    output.header = input_->header;
  };
  const auto clear_output = [&] {
    output = pcl::PolygonMesh();
    if (input_)
      output.header = input_->header;
  };
  run(std::cref(work), std::cref(clear_output));
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct(std::vector<pcl::Vertices>& polygons) {
  polygons = std::vector<pcl::Vertices>();
  const auto work = [&] { performReconstruction(polygons); };
  const auto clear_output = [&] { polygons = std::vector<pcl::Vertices>(); };
  run(std::cref(work), std::cref(clear_output));
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct() {
  const auto work = [&] { meshPoints(); };
  run(std::cref(work), [] {});
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::getSphereCoordinates() const {
  return detail::cloudOfVertices(result_.sphere, result_.vertex_of_input, used_indices_,
                                 input_size_);
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::getSmoothedPoints() const {
  if (result_.smoothed.cols() == 0)
    return pcl::PointCloud<pcl::PointXYZ>::Ptr(new pcl::PointCloud<pcl::PointXYZ>);
  return detail::cloudOfVertices(result_.smoothed, result_.vertex_of_input, used_indices_,
                                 input_size_);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(pcl::PolygonMesh& output) {
  performReconstruction(output.polygons);
  pcl::toPCLPointCloud2(*input_, output.cloud);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(
    std::vector<pcl::Vertices>& polygons) {
  meshPoints();
  polygons = detail::polygonsOf(result_.triangles, vertex_indices_);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::meshPoints() {
  std::function<detail::NeighborSource(const std::vector<spherical_param::Index>&)>
      use_search_method;
  if (tree_)
    use_search_method = [this](const std::vector<spherical_param::Index>& point_of_distinct) {
      return useSearchMethod(point_of_distinct);
    };
  const spherical_param::Positions points = collectPoints();
  result_ = detail::reconstructPoints(points, options_, ignored_points_, use_search_method);

  vertex_indices_.reserve(result_.input_of_vertex.size());
  for (const spherical_param::Index point : result_.input_of_vertex)
    vertex_indices_.push_back(used_indices_[static_cast<std::size_t>(point)]);
  input_size_ = input_->size();
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::run(const std::function<void()>& work,
                                                 const std::function<void()>& clear_output) {
  clearResults();
  std::exception_ptr callback_error;
  bool initialized = false;
  const auto whole_work = [&] {
    checkInput();
    initialized = initCompute();
    // initCompute() ignores that it had no memory for the indices.
    if (!initialized || (fake_indices_ && indices_->size() != input_->size()))
      throw std::bad_alloc();
    work();
  };
  std::string failure = detail::failureOf(std::cref(whole_work), callback_error);
  if (initialized)
    deinitCompute();
  // Copies of this object would share the indices that initCompute() made, across threads as well.
  if (fake_indices_)
    indices_.reset();
  if (failure.empty())
    return;

  clearResults();
  try {
    clear_output();
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
  detail::checkCloud(input_->size(), input_->width, input_->height);
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
      detail::refuseIndex(i, index, input_->size());
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
