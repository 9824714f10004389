#pragma once

#include <pcl/PCLHeader.h>
#include <pcl/PolygonMesh.h>
#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_reconstruction.h>
#include <pcl/types.h>

#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/sphere_surface.h"

#include <string>
#include <utility>
#include <vector>

namespace pcl {

/** \brief Parameters of morphSphericalParam(). */
struct SphericalParamMorphOptions {
  /** \brief How both surfaces are continued between their points. */
  spherical_param::SurfaceFit fit = spherical_param::SurfaceFit::Linear;
  /** \brief Points that become one: the index of each in the input cloud of its reconstruction. */
  std::vector<std::pair<pcl::index_t, pcl::index_t>> pairs;
  /** \brief Alignment and connectivity. Its pairs are those of vertices of the two results: they
   * come after `pairs`. Where no threads are given, those of the first reconstruction are used. */
  spherical_param::MorphOptions morph = {};
  /** \brief Parameters of both maps to the sphere. Where no threads are given, those of each
   * reconstruction are used. */
  spherical_param::SphereMapOptions map = {};
};

/** \brief Mesh two clouds and change one shape into the other, as a sequence of meshes: closed,
 * manifold, oriented outward, of genus 0, with the same polygons in each.
 *
 * \param[in,out] first with its input cloud set; its reconstruct() is called, and its results stay
 * there
 * \param[in,out] second likewise; another object
 * \param[in] frames meshes, those of both ends among them; 2 to 10000
 * \param[out] output the frames; their clouds have points of type pcl::PointXYZ, their header is
 * that of the first input
 * \param[in] options the defaults need no tuning
 * \param[out] impossible if it is given: the pairs that could not be honoured, by their place in
 * `pairs` and behind these in `morph.pairs`
 * \return false after a failure, which is told by PCL_ERROR; the output is empty then. No exception
 * leaves the function, except one that a progress callback throws.
 * \ingroup surface
 */
template <typename PointInT>
bool morphSphericalParam(SphericalParamReconstruction<PointInT>& first,
                         SphericalParamReconstruction<PointInT>& second, int frames,
                         std::vector<pcl::PolygonMesh>& output,
                         const SphericalParamMorphOptions& options = {},
                         std::vector<spherical_param::ImpossiblePair>* impossible = nullptr);

namespace detail {

/** \brief A mesh with its map. */
struct MappedMesh {
  spherical_param::Positions points;
  spherical_param::SphereMap map;
  /** \brief Of each point of the cloud; -1: it is none. */
  std::vector<spherical_param::Index> vertex_of_point;
};

/** \brief Tells of a number of frames that is out of range by PCL_ERROR. */
PCL_EXPORTS bool areFrames(int frames);

/** \brief Morphs two meshes that are mapped to the sphere.
 * \return false after a failure, with an empty output */
PCL_EXPORTS bool morph(const MappedMesh& first, const spherical_param::Triangles& first_triangles,
                       const MappedMesh& second, const spherical_param::Triangles& second_triangles,
                       int frames, const SphericalParamMorphOptions& options,
                       const pcl::PCLHeader& header, std::vector<pcl::PolygonMesh>& output,
                       std::vector<spherical_param::ImpossiblePair>* impossible);

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
