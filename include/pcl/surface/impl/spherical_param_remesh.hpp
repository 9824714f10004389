#pragma once

#include <pcl/surface/impl/spherical_param_map.hpp>
#include <pcl/surface/spherical_param_remesh.h>

namespace pcl {

template <typename PointInT>
bool remeshSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                          pcl::PolygonMesh& output, const SphericalParamRemeshOptions& options) {
  output = pcl::PolygonMesh();
  SphericalParamRemeshOptions with_threads;
  const bool is_ready = detail::runCore("remeshSphericalParam", [&] {
    with_threads = options;
    if (reconstruction.getInputCloud())
      output.header = reconstruction.getInputCloud()->header;
  });
  spherical_param::Positions points;
  spherical_param::SphereMap map;
  if (!is_ready || !computeSphericalParamMap(reconstruction, points, map, options.map))
    return false;
  if (with_threads.map.threads == 0)
    with_threads.map.threads = static_cast<int>(reconstruction.getNumberOfThreads());
  return detail::remesh(points, reconstruction.getResult().triangles, map.sphere, with_threads,
                        output);
}

}  // namespace pcl

#define PCL_INSTANTIATE_remeshSphericalParam(T)                                                    \
  template PCL_EXPORTS bool pcl::remeshSphericalParam<T>(pcl::SphericalParamReconstruction<T>&,    \
                                                         pcl::PolygonMesh&,                        \
                                                         const pcl::SphericalParamRemeshOptions&);
