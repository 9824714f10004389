#pragma once

#include <pcl/surface/impl/spherical_param_reconstruction.hpp>
#include <pcl/surface/spherical_param_map.h>

namespace pcl {

template <typename PointInT>
bool computeSphericalParamMap(SphericalParamReconstruction<PointInT>& reconstruction,
                              spherical_param::Positions& points, spherical_param::SphereMap& map,
                              const spherical_param::SphereMapOptions& options) {
  points.resize(3, 0);
  map = spherical_param::SphereMap();
  reconstruction.reconstruct();
  const spherical_param::Result& result = reconstruction.getResult();
  // It has told why.
  if (!reconstruction.getErrorMessage().empty())
    return false;
  spherical_param::SphereMapOptions with_threads;
  const bool has_points = detail::runCore("computeSphericalParamMap", [&] {
    with_threads = options;
    if (result.smoothed.cols() > 0) {
      points = result.smoothed;
      return;
    }
    const pcl::Indices& vertices = reconstruction.getVertexIndices();
    const auto& cloud = *reconstruction.getInputCloud();
    points.resize(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const PointInT& point = cloud[static_cast<std::size_t>(vertices[i])];
      points.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3d(
          static_cast<double>(point.x), static_cast<double>(point.y), static_cast<double>(point.z));
    }
  });
  if (with_threads.threads == 0)
    with_threads.threads = static_cast<int>(reconstruction.getNumberOfThreads());
  if (has_points && detail::mapMesh(points, result, with_threads, map))
    return true;
  points.resize(3, 0);
  return false;
}

}  // namespace pcl

#define PCL_INSTANTIATE_computeSphericalParamMap(T)                                                \
  template PCL_EXPORTS bool pcl::computeSphericalParamMap<T>(                                      \
      pcl::SphericalParamReconstruction<T>&, spherical_param::Positions&,                          \
      spherical_param::SphereMap&, const spherical_param::SphereMapOptions&);
