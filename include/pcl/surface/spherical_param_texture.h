#pragma once

#include <pcl/TextureMesh.h>
#include <pcl/surface/spherical_param_map.h>

#include "spherical_param/map/texture_atlas.h"

#include <cstring>

namespace pcl {

/** \brief Parameters of textureSphericalParam(). */
struct SphericalParamTextureOptions {
  /** \brief The layout of the image. */
  spherical_param::TextureAtlasOptions atlas = {};
  /** \brief Size and gutter of the image. Without a number of threads, those of the reconstruction
   * are used. */
  spherical_param::BakeOptions bake = {};
  /** \brief Paint a checkerboard although the points have colours. */
  bool checkerboard = false;
  /** \brief Squares of a checkerboard along each quarter of a great circle; [1, 4096]. */
  int checkerboard_cells = 8;
  /** \brief The name under which the caller will store the image: the mesh mentions it. */
  std::string image_file = "texture.png";
  /** \brief Parameters of the map to the sphere. Without a number of threads, those of the
   * reconstruction are used. */
  spherical_param::SphereMapOptions map = {};
};

/** \brief Mesh a cloud, and give the mesh a texture: the colours of the points, or a checkerboard
 * if their type has none. A mesh with handles is a failure: setHandles(HandleMode::None) cuts them.
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called, and its
 * results stay there
 * \param[out] output its cloud has points of type pcl::PointNormal, its header is that of the
 * input. The vertices of the mesh come first, then those that arise where triangles are cut, so
 * that none wraps round in the image. One material; three texture coordinates for each polygon, u
 * to the right and v up, in the order of the polygons.
 * \param[out] image the texture, row by row from the top
 * \param[in] options the defaults need no tuning
 * \return false after a failure, which PCL_ERROR reports; the output has nothing but its header
 * then, and the image is empty. No exception leaves the function, except one that a progress
 * callback throws.
 * \ingroup surface
 */
template <typename PointInT>
bool textureSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                           pcl::TextureMesh& output, spherical_param::TextureImage& image,
                           const SphericalParamTextureOptions& options = {});

namespace detail {

/** \brief A mesh that is mapped to the sphere, with a texture and without a header. The colours are
 * 3 x v, or none: a checkerboard. */
PCL_EXPORTS pcl::TextureMesh textureMesh(const MappedMesh& mesh,
                                         const spherical_param::Positions& colors,
                                         const SphericalParamTextureOptions& options, int threads,
                                         spherical_param::TextureImage& image);

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

/** \brief The colours of the vertices of the last mesh, 3 x v; empty for points without. */
template <typename PointInT>
spherical_param::Positions colorsOf(const SphericalParamReconstruction<PointInT>& reconstruction) {
  spherical_param::Positions colors;
  if constexpr (pcl::traits::has_color<PointInT>::value) {
    const pcl::Indices& vertices = reconstruction.getVertexIndices();
    const auto& cloud = *reconstruction.getInputCloud();
    colors.resize(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i)
      colors.col(static_cast<Eigen::Index>(i)) =
          colorOf(cloud[static_cast<std::size_t>(vertices[i])]);
  }
  return colors;
}

}  // namespace detail

template <typename PointInT>
bool textureSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                           pcl::TextureMesh& output, spherical_param::TextureImage& image,
                           const SphericalParamTextureOptions& options) {
  image = spherical_param::TextureImage();
  return detail::makeFromMap(
      "textureSphericalParam", reconstruction, options.map, options.bake.threads, output,
      [&](const detail::MappedMesh& mesh, int threads) {
        const spherical_param::Positions colors =
            options.checkerboard ? spherical_param::Positions() : detail::colorsOf(reconstruction);
        return detail::textureMesh(mesh, colors, options, threads, image);
      });
}

}  // namespace pcl
