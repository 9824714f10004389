#pragma once

#include <pcl/surface/impl/spherical_param_map.hpp>
#include <pcl/surface/spherical_param_morph.h>

#include <cstddef>

namespace pcl {
namespace detail {

/** \brief Meshes a cloud, maps the mesh, and finds the vertex of each point. */
template <typename PointInT>
bool mapForMorph(SphericalParamReconstruction<PointInT>& reconstruction,
                 const spherical_param::SphereMapOptions& options, MappedMesh& mesh) {
  if (!computeSphericalParamMap(reconstruction, mesh.points, mesh.map, options))
    return false;
  return runCore("morphSphericalParam", [&] {
    mesh.vertex_of_point.assign(reconstruction.getInputCloud()->size(), -1);
    const pcl::Indices& used = reconstruction.getUsedIndices();
    for (std::size_t i = 0; i < used.size(); ++i)
      mesh.vertex_of_point[static_cast<std::size_t>(used[i])] =
          reconstruction.getResult().vertex_of_input[i];
  });
}

}  // namespace detail

template <typename PointInT>
bool morphSphericalParam(SphericalParamReconstruction<PointInT>& first,
                         SphericalParamReconstruction<PointInT>& second, int frames,
                         std::vector<pcl::PolygonMesh>& output,
                         const SphericalParamMorphOptions& options,
                         std::vector<spherical_param::ImpossiblePair>* impossible) {
  output.clear();
  if (impossible != nullptr)
    impossible->clear();
  SphericalParamMorphOptions with_threads;
  if (!detail::areFrames(frames) ||
      !detail::runCore("morphSphericalParam", [&] { with_threads = options; }))
    return false;
  detail::MappedMesh first_mesh;
  detail::MappedMesh second_mesh;
  if (!detail::mapForMorph(first, options.map, first_mesh) ||
      !detail::mapForMorph(second, options.map, second_mesh))
    return false;
  if (with_threads.morph.threads == 0)
    with_threads.morph.threads = static_cast<int>(first.getNumberOfThreads());
  return detail::morph(first_mesh, first.getResult().triangles, second_mesh,
                       second.getResult().triangles, frames, with_threads,
                       first.getInputCloud()->header, output, impossible);
}

}  // namespace pcl

#define PCL_INSTANTIATE_morphSphericalParam(T)                                                     \
  template PCL_EXPORTS bool pcl::morphSphericalParam<T>(                                           \
      pcl::SphericalParamReconstruction<T>&, pcl::SphericalParamReconstruction<T>&, int,           \
      std::vector<pcl::PolygonMesh>&, const pcl::SphericalParamMorphOptions&,                      \
      std::vector<spherical_param::ImpossiblePair>*);
