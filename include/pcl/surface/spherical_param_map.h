#pragma once

#include <pcl/surface/spherical_param_reconstruction.h>

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/types.h"

#include <functional>
#include <string>

namespace pcl {

/** \brief Mesh a cloud and map the mesh to the unit sphere, one to one and with low distortion:
 * what texturing, remeshing and morphing begin with.
 *
 * The vertices of the mesh are those of reconstruction.getResult(), which stays there, with its
 * triangles; reconstruction.getVertexIndices() tells which points of the cloud they are.
 *
 * \param[in,out] reconstruction with its input cloud set; its reconstruct() is called
 * \param[out] points 3 x v, the vertices: smoothed, if setSmoothingSteps() asks for that
 * \param[out] map the map of these vertices
 * \param[in] options where no threads are given, those of the reconstruction are used
 * \return false after a failure, which is told by PCL_ERROR; points and map are empty then. No
 * exception leaves the function, except one that a progress callback throws.
 * \ingroup surface
 */
template <typename PointInT>
bool computeSphericalParamMap(SphericalParamReconstruction<PointInT>& reconstruction,
                              spherical_param::Positions& points, spherical_param::SphereMap& map,
                              const spherical_param::SphereMapOptions& options = {});

namespace detail {

/** \brief The core's messages begin with the name of the function; ours has its own. */
PCL_EXPORTS const char* withoutFunctionName(const char* message);

/** \brief Calls a piece of work that uses the core. Whatever exception it throws is told by
 * PCL_ERROR as one of a function. Needs no memory itself.
 * \return false after an exception */
PCL_EXPORTS bool runCore(const char* function, const std::function<void()>& work);
template <typename Work>
bool runCore(const char* function, const Work& work) {
  return runCore(function, std::function<void()>(std::cref(work)));
}

/** \brief Maps a mesh to the sphere; a failure is told as one of computeSphericalParamMap().
 * \return false after a failure, with an empty map */
PCL_EXPORTS bool mapMesh(const spherical_param::Positions& points,
                         const spherical_param::Result& mesh,
                         const spherical_param::SphereMapOptions& options,
                         spherical_param::SphereMap& map);

}  // namespace detail

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
