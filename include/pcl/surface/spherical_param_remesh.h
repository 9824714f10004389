#pragma once

#include <pcl/PCLHeader.h>
#include <pcl/PolygonMesh.h>
#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/map/resampling.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"

#include <cstddef>

namespace pcl {

/** \brief Parameters of remeshSphericalParam(). */
struct SphericalParamRemeshOptions {
  /** \brief The regular mesh of the sphere that gives the new mesh its triangles. */
  spherical_param::SphereGrid grid = spherical_param::SphereGrid::Icosahedral;
  /** \brief Number of vertices, of which the nearest possible is used; 0: as many as the mesh of
   * the cloud has. Up to 2^29. */
  std::size_t points = 0;
  /** \brief How the surface is continued between the points of the cloud. */
  spherical_param::SurfaceFit fit = spherical_param::SurfaceFit::Smooth;
  /** \brief Parameters of the map to the sphere, which by default keeps angles more than for other
   * uses: long thin triangles cut across folds of the surface. Where no threads are given, those of
   * the reconstruction are used, in all steps. */
  spherical_param::SphereMapOptions map = makeMapOptions();

private:
  static spherical_param::SphereMapOptions makeMapOptions() {
    spherical_param::SphereMapOptions options;
    options.area_weight = 0.5;
    options.sweeps = 40;
    return options;
  }
};

/** \brief Mesh a cloud, and sample the surface anew with a regular mesh of the sphere: closed,
 * manifold, oriented outward, of genus 0, with as many vertices as one likes. Vertices are slid
 * along the surface where triangles would intersect (see spherical_param::untangle()).
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called, and its
 * results stay there
 * \param[out] output its cloud has points of type pcl::PointNormal, its header is that of the input
 * \param[in] options the defaults need no tuning
 * \return false after a failure, which is told by PCL_ERROR; the output has nothing but its header
 * then. No exception leaves the function, except one that a progress callback throws.
 * \note The triangles are even on the sphere, and less so on the surface, the more its map had to
 * distort areas (see spherical_param::SphereMap::distortion).
 * \ingroup surface
 */
template <typename PointInT>
bool remeshSphericalParam(SphericalParamReconstruction<PointInT>& reconstruction,
                          pcl::PolygonMesh& output,
                          const SphericalParamRemeshOptions& options = {});

namespace detail {

/** \brief Samples a mesh that is mapped to the sphere; clears the output first.
 * \return false after a failure, with an empty output */
PCL_EXPORTS bool remesh(const spherical_param::Positions& points,
                        const spherical_param::Triangles& triangles,
                        const spherical_param::Positions& sphere,
                        const SphericalParamRemeshOptions& options, pcl::PolygonMesh& output);

}  // namespace detail

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
