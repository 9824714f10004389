#pragma once

#include <pcl/point_traits.h>
#include <pcl/surface/impl/spherical_param_map.hpp>
#include <pcl/surface/spherical_param_texture.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pcl {
namespace detail {

/** \brief Red, green and blue of a point, whose type may name its field rgb or rgba. */
template <typename PointT>
Eigen::Vector3d colorOf(const PointT& point) {
  std::size_t offset = 0;
  if constexpr (pcl::traits::has_field<PointT, pcl::fields::rgba>::value)
    offset = pcl::traits::offset<PointT, pcl::fields::rgba>::value;
  else
    offset = pcl::traits::offset<PointT, pcl::fields::rgb>::value;
  std::uint32_t packed = 0;
  std::memcpy(&packed, reinterpret_cast<const std::uint8_t*>(&point) + offset, sizeof packed);
  return Eigen::Vector3d(packed >> 16 & 0xFF, packed >> 8 & 0xFF, packed & 0xFF);
}

}  // namespace detail

template <typename PointInT>
bool textureSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                           pcl::TextureMesh& output, spherical_param::TextureImage& image,
                           const SphericalParamTextureOptions& options) {
  output = pcl::TextureMesh();
  image = spherical_param::TextureImage();
  SphericalParamTextureOptions with_threads;
  const bool is_ready = detail::runCore("textureSphericalParam", [&] {
    with_threads = options;
    if (reconstruction.getInputCloud())
      output.header = reconstruction.getInputCloud()->header;
  });
  spherical_param::Positions points;
  spherical_param::SphereMap map;
  if (!is_ready || !computeSphericalParamMap(reconstruction, points, map, options.map))
    return false;
  spherical_param::Positions colors;
  const bool has_colors = detail::runCore("textureSphericalParam", [&] {
    if constexpr (pcl::traits::has_color<PointInT>::value) {
      if (options.checkerboard)
        return;
      const pcl::Indices& vertices = reconstruction.getVertexIndices();
      const auto& cloud = *reconstruction.getInputCloud();
      colors.resize(3, static_cast<Eigen::Index>(vertices.size()));
      for (std::size_t i = 0; i < vertices.size(); ++i)
        colors.col(static_cast<Eigen::Index>(i)) =
            detail::colorOf(cloud[static_cast<std::size_t>(vertices[i])]);
    }
  });
  if (with_threads.bake.threads == 0)
    with_threads.bake.threads = static_cast<int>(reconstruction.getNumberOfThreads());
  return has_colors && detail::textureMesh(points, reconstruction.getResult().triangles, map.sphere,
                                           colors, with_threads, output, image);
}

}  // namespace pcl

#define PCL_INSTANTIATE_textureSphericalParam(T)                                                   \
  template PCL_EXPORTS bool pcl::textureSphericalParam<T>(                                         \
      pcl::SphericalParamReconstruction<T>&, pcl::TextureMesh&, spherical_param::TextureImage&,    \
      const pcl::SphericalParamTextureOptions&);
