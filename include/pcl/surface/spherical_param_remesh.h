#pragma once

#include <pcl/surface/spherical_param_map.h>

#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_surface.h"

namespace pcl {

/** \brief Parameters of remeshSphericalParam(). */
struct SphericalParamRemeshOptions {
  /** \brief The regular mesh of the sphere that gives the new mesh its triangles. */
  spherical_param::SphereGrid grid = spherical_param::SphereGrid::Icosahedral;
  /** \brief Number of vertices, up to 2^29; the nearest possible number is used. 0: as many as the
   * mesh of the cloud. */
  std::size_t points = 0;
  /** \brief How the surface is continued between the points of the cloud. */
  spherical_param::SurfaceFit fit = spherical_param::SurfaceFit::Smooth;
  /** \brief Parameters of the map to the sphere. The default favours angles: long thin triangles
   * cut across folds of the surface. Without a number of threads, those of the reconstruction are
   * used, in all steps. */
  spherical_param::SphereMapOptions map = spherical_param::mapOptionsForResampling();
};

/** \brief Mesh a cloud, and sample the surface anew with a regular mesh of the sphere: manifold,
 * oriented outward, of genus 0, with any number of vertices. It is closed, except for openings that
 * setSurface() leaves open. Vertices are slid along the surface where triangles would intersect
 * (see spherical_param::untangle()).
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called, and its
 * results stay there
 * \param[out] output its cloud has points of type pcl::PointNormal, its header is that of the input
 * \param[in] options the defaults need no tuning
 * \return false after a failure, which PCL_ERROR reports; the output has nothing but its header
 * then. No exception leaves the function, except one that a progress callback throws.
 * \note The triangles are even on the sphere, and on the surface as far as its map keeps areas (see
 * spherical_param::SphereMap::distortion).
 * \ingroup surface */
template <typename PointInT>
bool remeshSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                          pcl::PolygonMesh& output,
                          const SphericalParamRemeshOptions& options = {});

namespace detail {

/** \brief A mesh that is mapped to the sphere, sampled anew, without a header. */
PCL_EXPORTS pcl::PolygonMesh remesh(const MappedMesh& mesh,
                                    const SphericalParamRemeshOptions& options, int threads);

}  // namespace detail

template <typename PointInT>
bool remeshSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                          pcl::PolygonMesh& output, const SphericalParamRemeshOptions& options) {
  return detail::makeFromMap("remeshSphericalParam", reconstruction, options.map,
                             options.map.threads, output,
                             [&](const detail::MappedMesh& mesh, int threads) {
                               return detail::remesh(mesh, options, threads);
                             });
}

}  // namespace pcl
