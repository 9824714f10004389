#pragma once

#include <pcl/surface/impl/spherical_param_run_core.hpp>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/map/sphere_map.h"

#include <utility>

namespace pcl {

/** \brief Mesh a cloud and map the mesh to the unit sphere, one to one and with low distortion,
 * for texturing, remeshing and morphing.
 *
 * The vertices of the mesh are those of reconstruction.getResult(), which stays there, with its
 * triangles; reconstruction.getVertexIndices() has their indices in the cloud. With
 * setDetails(true) the map is turned as the embedding is.
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called
 * \param[out] points 3 x v, the vertices: consolidated and smoothed if the options say so
 * \param[out] map the map of these vertices
 * \param[in] options without a number of threads, that of the reconstruction is used
 * \return false after a failure, which PCL_ERROR reports: also for a mesh with handles, which
 * setHandles(HandleMode::None) cuts. Points and map are empty then. No
 * exception leaves the function, except one that a progress callback throws. \ingroup surface
 */
template <typename PointInT>
bool computeSphericalParamMap(SphericalParamReconstruction<PointInT>& reconstruction,
                              spherical_param::Positions& points, spherical_param::SphereMap& map,
                              const spherical_param::SphereMapOptions& options = {});

namespace detail {

/** \brief A mesh with its map to the sphere. */
struct MappedMesh {
  spherical_param::Positions points;
  spherical_param::Triangles triangles;
  spherical_param::SphereMap map;
};

/** \brief Throws InvalidInput for a mesh without a map to one sphere. */
PCL_EXPORTS void requireMap(const spherical_param::Surface& surface);

/** \brief Meshes a cloud and maps the mesh. \return false after a failure */
template <typename PointInT>
bool mapMesh(SphericalParamReconstruction<PointInT>& reconstruction,
             const spherical_param::SphereMapOptions& options, MappedMesh& mesh) {
  mesh = {};
  reconstruction.reconstruct();
  // The reconstruction has reported why.
  if (!reconstruction.getErrorMessage().empty())
    return false;
  const auto work = [&](const spherical_param::Execution& execution) {
    spherical_param::SphereMapOptions guarded = options;
    static_cast<spherical_param::Execution&>(guarded) = execution;
    const spherical_param::Surface& result = reconstruction.getResult().surface();
    requireMap(result);
    spherical_param::SphereMap map =
        spherical_param::computeSphereMap(result.points, result.triangles, result.sphere, guarded);
    mesh = {result.points, result.triangles, std::move(map)};
  };
  return runCore("computeSphericalParamMap", options, reconstruction.getNumberOfThreads(), work);
}

/** \brief Meshes a cloud, maps the mesh, and makes an output of it; only its header is left after a
 * failure. `make` is called with the mesh and with `threads`, or else those of the reconstruction.
 * \return false after a failure */
template <typename PointInT, typename Output, typename Make>
bool makeFromMap(const char* function, SphericalParamReconstruction<PointInT>& reconstruction,
                 const spherical_param::SphereMapOptions& options, int threads, Output& output,
                 const Make& make) {
  output = Output();
  MappedMesh mesh;
  const auto keep_header = [&](const spherical_param::Execution&) {
    if (reconstruction.getInputCloud())
      output.header = reconstruction.getInputCloud()->header;
  };
  const auto work = [&](const spherical_param::Execution& execution) {
    Output made = make(std::as_const(mesh), execution.threads);
    made.header = output.header;
    made.cloud.header = output.header;
    output = std::move(made);
  };
  return runCore(function, {}, 0, keep_header) && mapMesh(reconstruction, options, mesh) &&
         runCore(function, {threads, {}}, reconstruction.getNumberOfThreads(), work);
}

}  // namespace detail

template <typename PointInT>
bool computeSphericalParamMap(SphericalParamReconstruction<PointInT>& reconstruction,
                              spherical_param::Positions& points, spherical_param::SphereMap& map,
                              const spherical_param::SphereMapOptions& options) {
  detail::MappedMesh mesh;
  const bool is_done = detail::mapMesh(reconstruction, options, mesh);
  points = std::move(mesh.points);
  map = std::move(mesh.map);
  return is_done;
}

}  // namespace pcl
