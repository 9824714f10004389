#pragma once

#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/surface/impl/spherical_param_run_core.hpp>
#include <pcl/surface/impl/spherical_param_user_search.hpp>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/errors.h"

#include <exception>
#include <new>
#include <utility>

namespace pcl {
namespace detail {

/** \brief Throws InvalidInput for an empty cloud, or one whose width and height do not fit. */
PCL_EXPORTS void checkCloud(std::size_t points, std::size_t width, std::size_t height);

/** \brief Throws InvalidInput for an entry of the indices that is out of range. */
[[noreturn]] PCL_EXPORTS void rejectIndex(std::size_t entry, pcl::index_t index,
                                          std::size_t points);

/** \brief Makes a cloud of NaN. */
PCL_EXPORTS pcl::PointCloud<pcl::PointXYZ>::Ptr cloudOfNothing(std::size_t points);

/** \brief Makes polygons of points from triangles of vertices. */
PCL_EXPORTS std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles,
                                                  const pcl::Indices& point_of_vertex);

}  // namespace detail

template <typename PointInT>
SphericalParamReconstruction<PointInT>::SphericalParamReconstruction() {
  // The base class would give all points to the search, also those that are not finite.
  check_tree_ = false;
  options_.consolidation = ConsolidationMode::None;
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct(pcl::PolygonMesh& output) {
  output = pcl::PolygonMesh();
  if (input_)
    output.header = input_->header;
  run([&] {
    pcl::PolygonMesh mesh;  // a failure leaves the output empty
    performReconstruction(mesh);
    output.cloud = std::move(mesh.cloud);
    output.polygons = std::move(mesh.polygons);
  });
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct(std::vector<pcl::Vertices>& polygons) {
  polygons = std::vector<pcl::Vertices>();
  run([&] {
    std::vector<pcl::Vertices> triangles;
    performReconstruction(triangles);
    polygons = std::move(triangles);
  });
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::reconstruct() {
  run([&] { meshPoints(FillMode::Flat); });
}

template <typename PointInT>
pcl::PointCloud<pcl::PointXYZ>::Ptr
SphericalParamReconstruction<PointInT>::getSphereCoordinates() const {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud = detail::cloudOfNothing(input_size_);
  std::size_t placed = 0;
  for (std::size_t part = 0; part < result_.surfaces.size(); ++part) {
    const spherical_param::Surface& surface = result_.surfaces[part];
    if (surface.sphere.cols() == 0)
      continue;
    const pcl::Indices& used = parts_[part].used_indices;
    for (std::size_t i = 0; i < used.size(); ++i)
      (*cloud)[static_cast<std::size_t>(used[i])].getVector3fMap() =
          surface.sphere.col(surface.vertex_of_input[i]).template cast<float>();
    placed += used.size();
  }
  cloud->is_dense = placed == input_size_;
  return placed == 0 ? detail::cloudOfNothing(0) : cloud;
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(pcl::PolygonMesh& output) {
  meshPoints(options_.fill);
  const spherical_param::JoinedMesh mesh = spherical_param::joined(result_);
  pcl::Indices point_of_vertex = vertexIndices();
  PointCloudIn cloud = *input_;
  for (std::size_t v = 0; v < point_of_vertex.size(); ++v) {
    if (mesh.is_added[v] != 0) {
      cloud.push_back(PointInT(cloud[static_cast<std::size_t>(point_of_vertex[v])]));
      point_of_vertex[v] = static_cast<pcl::index_t>(cloud.size() - 1);
    }
    PointInT& point = cloud[static_cast<std::size_t>(point_of_vertex[v])];
    const auto place = mesh.points.col(static_cast<Eigen::Index>(v)).template cast<float>();
    point.x = place.x();
    point.y = place.y();
    point.z = place.z();
  }
  pcl::toPCLPointCloud2(cloud, output.cloud);
  output.polygons = detail::polygonsOf(mesh.triangles, point_of_vertex);
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::performReconstruction(
    std::vector<pcl::Vertices>& polygons) {
  meshPoints(FillMode::Flat);
  polygons = detail::polygonsOf(spherical_param::joined(result_).triangles, vertexIndices());
}

template <typename PointInT>
pcl::Indices SphericalParamReconstruction<PointInT>::vertexIndices() const {
  pcl::Indices all;
  for (const PartIndices& part : parts_)
    all.insert(all.end(), part.vertex_indices.begin(), part.vertex_indices.end());
  return all;
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::meshPoints(FillMode fill) {
  pcl::Indices used_indices;
  const spherical_param::Positions points = collectPoints(used_indices);
  input_size_ = input_->size();
  spherical_param::NeighborSearchFactory search_of;
  if (tree_)
    search_of = [&](const std::vector<spherical_param::Index>& searched) {
      return detail::useSearch<PointInT>(*tree_, input_, used_indices, searched);
    };
  spherical_param::Options options = options_;
  options.fill = fill;
  options.progress = detail::guardProgress(options_.progress);
  result_ = spherical_param::reconstruct(points, options, search_of, infoOf(points, used_indices));
  for (const std::string& failure : result_.failures)
    PCL_WARN("[pcl::SphericalParamReconstruction::reconstruct] %s\n", failure.c_str());
  const auto indices_of = [&](const std::vector<spherical_param::Index>& inputs) {
    pcl::Indices indices;
    indices.reserve(inputs.size());
    for (const spherical_param::Index input : inputs)
      indices.push_back(used_indices[static_cast<std::size_t>(input)]);
    return indices;
  };
  parts_.clear();
  for (const spherical_param::Surface& surface : result_.surfaces)
    parts_.push_back({indices_of(surface.inputs), indices_of(surface.input_of_vertex)});
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::run(const std::function<void()>& work) {
  clearResults();
  std::exception_ptr callback_error;
  bool initialized = false;
  const auto whole_work = [&] {
    checkInput();
    initialized = initCompute();
    // initCompute() does not report a lack of memory for the indices.
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
  error_message_ = std::move(failure);
  if (callback_error)
    std::rethrow_exception(callback_error);
  PCL_ERROR("[pcl::SphericalParamReconstruction::reconstruct] %s\n", error_message_.c_str());
}

template <typename PointInT>
void SphericalParamReconstruction<PointInT>::clearResults() {
  result_ = spherical_param::Result();
  parts_ = std::vector<PartIndices>(1);
  input_size_ = 0;
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
spherical_param::CloudInfo
SphericalParamReconstruction<PointInT>::infoOf(const spherical_param::Positions& points,
                                               const pcl::Indices& used_indices) const {
  spherical_param::CloudInfo info;
  info.viewpoint = spherical_param::viewpointOf(
      points, input_->sensor_origin_.template head<3>().template cast<double>(),
      input_->height > 1);
  if constexpr (pcl::traits::has_normal<PointInT>::value) {
    info.normals.resize(3, static_cast<Eigen::Index>(used_indices.size()));
    for (std::size_t i = 0; i < used_indices.size(); ++i)
      info.normals.col(static_cast<Eigen::Index>(i)) =
          (*input_)[static_cast<std::size_t>(used_indices[i])]
              .getNormalVector3fMap()
              .template cast<double>();
  }
  return info;
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
    used_indices.push_back(index);
  }
  used_indices.shrink_to_fit();

  return detail::positionsOf(*input_, used_indices);
}

}  // namespace pcl

#define PCL_INSTANTIATE_SphericalParamReconstruction(T)                                            \
  template class PCL_EXPORTS pcl::SphericalParamReconstruction<T>;
