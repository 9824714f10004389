#pragma once

#include <pcl/PCLHeader.h>
#include <pcl/TextureMesh.h>
#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/sphere_map.h"
#include "spherical_param/texture_atlas.h"
#include "spherical_param/types.h"

#include <string>

namespace pcl {

/** \brief Parameters of textureSphericalParam(). */
struct SphericalParamTextureOptions {
  /** \brief The layout of the image. */
  spherical_param::TextureAtlasOptions atlas = {};
  /** \brief Size and gutter of the image. Where no threads are given, those of the reconstruction
   * are used. */
  spherical_param::BakeOptions bake = {};
  /** \brief Paint a checkerboard although the points have colours. */
  bool checkerboard = false;
  /** \brief Squares of a checkerboard along each quarter of a great circle; [1, 4096]. */
  int checkerboard_cells = 8;
  /** \brief The name under which the caller will store the image: the mesh mentions it. */
  std::string image_file = "texture.png";
  /** \brief Parameters of the map to the sphere. Where no threads are given, those of the
   * reconstruction are used. */
  spherical_param::SphereMapOptions map = {};
};

/** \brief Mesh a cloud, and give the mesh a texture: the colours of the points, or a checkerboard
 * if their type has none.
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called, and its
 * results stay there
 * \param[out] output its cloud has points of type pcl::PointNormal, its header is that of the
 * input. The vertices of the mesh come first, then those that arise where triangles are cut, so
 * that none wraps round in the image. One material; three texture coordinates for each polygon, u
 * to the right and v up, in the order of the polygons.
 * \param[out] image the texture, row by row from the top
 * \param[in] options the defaults need no tuning
 * \return false after a failure, which is told by PCL_ERROR; the output has nothing but its header
 * then, and the image is empty. No exception leaves the function, except one that a progress
 * callback throws.
 * \ingroup surface
 */
template <typename PointInT>
bool textureSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                           pcl::TextureMesh& output, spherical_param::TextureImage& image,
                           const SphericalParamTextureOptions& options = {});

namespace detail {

/** \brief Gives a mesh that is mapped to the sphere a texture; clears the output first.
 * \param[in] colors 3 x v, or empty: a checkerboard
 * \return false after a failure, with an empty output */
PCL_EXPORTS bool textureMesh(const spherical_param::Positions& points,
                             const spherical_param::Triangles& triangles,
                             const spherical_param::Positions& sphere,
                             const spherical_param::Positions& colors,
                             const SphericalParamTextureOptions& options, pcl::TextureMesh& output,
                             spherical_param::TextureImage& image);

}  // namespace detail
}  // namespace pcl

#ifdef PCL_NO_PRECOMPILE
#include <pcl/surface/impl/spherical_param_texture.hpp>
#endif
