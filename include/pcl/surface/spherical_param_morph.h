#pragma once

#include <pcl/surface/spherical_param_map.h>

#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_surface.h"

namespace pcl {

/** \brief Parameters of morphSphericalParam(). */
struct SphericalParamMorphOptions {
  /** \brief How both surfaces are continued between their points. */
  spherical_param::SurfaceFit fit = spherical_param::SurfaceFit::Linear;
  /** \brief Points that become one: the index of each in the input cloud of its reconstruction. */
  std::vector<std::pair<pcl::index_t, pcl::index_t>> pairs;
  /** \brief Alignment and connectivity. Its pairs are vertices of the two results and come after
   * `pairs`. Without a number of threads, those of the first reconstruction are used. */
  spherical_param::MorphOptions morph = {};
  /** \brief Parameters of both maps to the sphere. Without a number of threads, those of each
   * reconstruction are used. */
  spherical_param::SphereMapOptions map = {};
};

/** \brief Mesh two clouds and change one shape into the other, as a sequence of meshes:
 * manifold, oriented outward, of genus 0, with the same polygons in each; closed, except for
 * openings that setSurface() leaves open in either surface.
 *
 * \param[in,out] first with its input cloud set; its reconstruct() is called, and its results stay
 * there
 * \param[in,out] second likewise; another object
 * \param[in] frames number of meshes including both ends; 2 to 10000
 * \param[out] output the frames; their clouds have points of type pcl::PointXYZ, their header is
 * that of the first input
 * \param[in] options the defaults need no tuning
 * \param[out] impossible if it is given: the pairs that could not be honoured, by their index in
 * `pairs`, continued in `morph.pairs`
 * \return false after a failure, which PCL_ERROR reports; the output is empty then. No exception
 * leaves the function, except one that a progress callback throws. \ingroup surface
 */
template <typename PointInT>
bool morphSphericalParam(SphericalParamReconstruction<PointInT>& first,
                         SphericalParamReconstruction<PointInT>& second, int frames,
                         std::vector<pcl::PolygonMesh>& output,
                         const SphericalParamMorphOptions& options = {},
                         std::vector<spherical_param::ImpossiblePair>* impossible = nullptr);

namespace detail {

/** \brief One of the two shapes. */
struct MorphShape {
  MappedMesh mesh;
  /** \brief The vertex of each point of the cloud; -1: none. */
  std::vector<spherical_param::Index> vertex_of_point;
};

/** \brief Throws InvalidInput for a number of frames that is out of range. */
PCL_EXPORTS void checkFrames(int frames);

/** \brief The frames between two meshes that are mapped to the sphere, with `execution` instead of
 * that of the options. */
PCL_EXPORTS std::vector<pcl::PolygonMesh>
morph(const MorphShape& first, const MorphShape& second, int frames,
      const SphericalParamMorphOptions& options, const spherical_param::Execution& execution,
      const pcl::PCLHeader& header, std::vector<spherical_param::ImpossiblePair>* impossible);

/** \brief Meshes and maps a cloud, and finds the vertex of each point. \return false: it failed */
template <typename PointInT>
bool mapForMorph(SphericalParamReconstruction<PointInT>& reconstruction,
                 const spherical_param::SphereMapOptions& options, MorphShape& shape) {
  const auto work = [&](const spherical_param::Execution&) {
    shape.vertex_of_point.assign(reconstruction.getInputCloud()->size(), -1);
    const pcl::Indices& used = reconstruction.getUsedIndices();
    for (std::size_t i = 0; i < used.size(); ++i)
      shape.vertex_of_point[static_cast<std::size_t>(used[i])] =
          reconstruction.getResult().surface().vertex_of_input[i];
  };
  return mapMesh(reconstruction, options, shape.mesh) &&
         runCore("morphSphericalParam", {}, 0, work);
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
  detail::MorphShape shapes[2];
  const auto check = [&](const spherical_param::Execution&) { detail::checkFrames(frames); };
  const auto work = [&](const spherical_param::Execution& execution) {
    output = detail::morph(shapes[0], shapes[1], frames, options, execution,
                           first.getInputCloud()->header, impossible);
  };
  constexpr const char* name = "morphSphericalParam";
  return detail::runCore(name, {}, 0, check) &&
         detail::mapForMorph(first, options.map, shapes[0]) &&
         detail::mapForMorph(second, options.map, shapes[1]) &&
         detail::runCore(name, options.morph, first.getNumberOfThreads(), work);
}

}  // namespace pcl
