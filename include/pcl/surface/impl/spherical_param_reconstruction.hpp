#pragma once

#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/surface/impl/spherical_param_run_core.hpp>
#include <pcl/surface/impl/spherical_param_user_search.hpp>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/errors.h"

#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcl {
namespace detail {

/** \brief Throws InvalidInput for a cloud without points, or with a width and a height of another
 * number of points. */
PCL_EXPORTS void checkCloud(std::size_t points, std::size_t width, std::size_t height);

/** \brief Throws InvalidInput for an entry of the indices that is out of range. */
[[noreturn]] PCL_EXPORTS void rejectIndex(std::size_t entry, pcl::index_t index,
                                          std::size_t points);

/** \brief Makes a cloud of NaN. */
PCL_EXPORTS pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOfNothing(std::size_t points);

/** \brief Gives the used points of a cloud the positions of vertices, 3 x v.
 * \param[in] vertex_of_used the vertex of each of the used points */
PCL_EXPORTS void placeVertices(const spherical_param::Positions& vertices,
                               const std::vector<spherical_param::Index>& vertex_of_used,
                               const pcl::Indices& used_points,
                               pcl::PointCloud<pcl::PointXYZ>& cloud);

/** \brief Appends triangles of vertices as polygons of points. */
PCL_EXPORTS void appendPolygons(const spherical_param::Triangles& triangles,
                                const pcl::Indices& point_of_vertex,
                                std::vector<pcl::Vertices>& polygons);

/** \brief The parts of a cloud that are meshed; numbers of the points.
 * \param[in] options their progress callback may throw */
PCL_EXPORTS std::vector<spherical_param::Part>
choosePoints(const spherical_param::Positions& points, spherical_param::PartsMode mode,
             int min_points, const spherical_param::Options& options);

/** \brief Meshes points with the core.
 * \param[in] options their progress callback may throw
 * \param[in] ignored_points points of the cloud that are not finite, for messages
 * \param[in] search finds the neighbours; null: the core does */
PCL_EXPORTS spherical_param::Surface reconstructPoints(const spherical_param::Positions& points,
                                                      spherical_param::Options options,
                                                      std::size_t ignored_points,
                                                      const UserSearch* search);

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
  return cloudOf(&spherical_param::Surface::sphere);
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr SphericalParamReconstruction<PointInT>::getMovedPoints() const {
  if (parts_.front().result.moved().cols() == 0)
    return detail::cloudOfNothing(0);
  return cloudOf(&spherical_param::Surface::moved);
}

template <typename PointInT>
template <typename Places>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::cloudOf(Places places) const {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud = detail::cloudOfNothing(input_size_);
  std::size_t used = 0;
  for (const MeshedPart& part : parts_) {
    detail::placeVertices(std::invoke(places, part.result), part.result.vertex_of_input,
                          part.used_indices, *cloud);
    used += part.used_indices.size();
  }
  cloud->is_dense = used == input_size_;
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
  meshPoints();
  polygons.clear();
  for (const MeshedPart& part : parts_)
    detail::appendPolygons(part.result.triangles, part.vertex_indices, polygons);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::meshPoints() {
  pcl::Indices used_indices;
  const spherical_param::Positions points = collectPoints(used_indices);
  input_size_ = input_->size();
  if (parts_mode_ == PartsMode::All) {
    parts_.front() = meshPart(std::move(used_indices), points);
    return;
  }
  std::vector<MeshedPart> meshed;
  std::exception_ptr failure;
  for (const spherical_param::Part& part :
       detail::choosePoints(points, parts_mode_, min_part_size_, options_)) {
    pcl::Indices of_part;
    of_part.reserve(part.points.size());
    for (const spherical_param::Index point : part.points)
      of_part.push_back(used_indices[static_cast<std::size_t>(point)]);
    try {
      meshed.push_back(meshPart(std::move(of_part), points(Eigen::all, part.points)));
    } catch (const spherical_param::InvalidInput& error) {
      failure = failure ? failure : std::current_exception();
      PCL_WARN("[pcl::SphericalParamReconstruction::reconstruct] a part of %zu points is left out: "
               "%s\n",
               part.points.size(), error.what());
    }
  }
  if (meshed.empty())
    std::rethrow_exception(failure);
  parts_ = std::move(meshed);
}

template <typename PointInT>
typename SphericalParamReconstruction<PointInT>::MeshedPart
SphericalParamReconstruction<PointInT>::meshPart(pcl::Indices used_indices,
                                                 const spherical_param::Positions& points) {
  MeshedPart part;
  part.used_indices = std::move(used_indices);
  std::optional<detail::UserSearch> search;
  if (tree_ && points.cols() > 0)
    search = detail::useSearch<PointInT>(*tree_, input_, part.used_indices, points);
  part.result =
      detail::reconstructPoints(points, options_, ignored_points_, search ? &*search : nullptr);
  part.vertex_indices.reserve(part.result.input_of_vertex.size());
  for (const spherical_param::Index point : part.result.input_of_vertex)
    part.vertex_indices.push_back(part.used_indices[static_cast<std::size_t>(point)]);
  return part;
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
    // Another failure is reported already.
  }
  error_message_ = std::move(failure);
  if (callback_error)
    std::rethrow_exception(callback_error);
  PCL_ERROR("[pcl::SphericalParamReconstruction::reconstruct] %s\n", error_message_.c_str());
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::clearResults() {
  parts_ = std::vector<MeshedPart>(1);
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
spherical_param::Positions
SphericalParamReconstruction<PointInT>::collectPoints(pcl::Indices& used_indices) {
  std::vector<bool> seen(input_->size(), false);
  used_indices.reserve(indices_->size());
  for (std::size_t i = 0; i < indices_->size(); ++i) {
    const pcl::index_t index = (*indices_)[i];
    if (index < 0 || static_cast<std::size_t>(index) >= input_->size())
      detail::rejectIndex(i, index, input_->size());
    const auto position = static_cast<std::size_t>(index);
    if (seen[position])
      continue;
    seen[position] = true;
    const PointInT& point = (*input_)[position];
    if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z))
      used_indices.push_back(index);
    else
      ++ignored_points_;
  }
  used_indices.shrink_to_fit();

  spherical_param::Positions points(3, static_cast<Eigen::Index>(used_indices.size()));
  for (std::size_t i = 0; i < used_indices.size(); ++i) {
    const PointInT& point = (*input_)[static_cast<std::size_t>(used_indices[i])];
    points.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(
        static_cast<double>(point.x), static_cast<double>(point.y), static_cast<double>(point.z));
  }
  return points;
}

}  // namespace pcl

#define PCL_INSTANTIATE_SphericalParamReconstruction(T)                                            \
  template class PCL_EXPORTS pcl::SphericalParamReconstruction<T>;
