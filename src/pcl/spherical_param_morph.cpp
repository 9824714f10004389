#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_morph.h>

#include "spherical_param/errors.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <string>
#include <utility>

namespace pcl {
namespace detail {

bool areFrames(int frames) {
  constexpr int most_frames = 10000;
  return runCore("morphSphericalParam", [frames] {
    if (frames < 2 || frames > most_frames)
      throw spherical_param::InvalidInput("frames = " + std::to_string(frames) +
                                          " is out of range; use 2 to " +
                                          std::to_string(most_frames));
  });
}

bool morph(const MappedMesh& first, const spherical_param::Triangles& first_triangles,
           const MappedMesh& second, const spherical_param::Triangles& second_triangles, int frames,
           const SphericalParamMorphOptions& options, const pcl::PCLHeader& header,
           std::vector<pcl::PolygonMesh>& output,
           std::vector<spherical_param::ImpossiblePair>* impossible) {
  std::vector<pcl::PolygonMesh> meshes;
  std::vector<spherical_param::ImpossiblePair> lost;
  std::exception_ptr callback_error;
  const bool is_done = runCore("morphSphericalParam", [&] {
    spherical_param::MorphOptions morph_options = options.morph;
    morph_options.pairs.clear();
    if (options.morph.progress)
      morph_options.progress = [&options, &callback_error](double share) {
        try {
          return options.morph.progress(share);
        } catch (...) {
          callback_error = std::current_exception();
          return false;
        }
      };
    std::vector<std::size_t> numbers;  // of the pairs, among those of the caller
    for (std::size_t i = 0; i < options.pairs.size(); ++i) {
      const std::array<std::pair<pcl::index_t, const MappedMesh*>, 2> sides{
          {{options.pairs[i].first, &first}, {options.pairs[i].second, &second}}};
      std::array<spherical_param::Index, 2> vertices{-1, -1};
      for (std::size_t side = 0; side < 2; ++side) {
        const auto& [point, mesh] = sides[side];
        if (point >= 0 && static_cast<std::size_t>(point) < mesh->vertex_of_point.size())
          vertices[side] = mesh->vertex_of_point[static_cast<std::size_t>(point)];
        if (vertices[side] < 0 && (lost.empty() || lost.back().pair != i))
          lost.push_back({i, "point " + std::to_string(point) + " of the " +
                                 (side == 0 ? "first" : "second") + " cloud was not meshed"});
      }
      if (vertices[0] >= 0 && vertices[1] >= 0) {
        morph_options.pairs.push_back({vertices[0], vertices[1]});
        numbers.push_back(i);
      }
    }
    for (std::size_t i = 0; i < options.morph.pairs.size(); ++i) {
      morph_options.pairs.push_back(options.morph.pairs[i]);
      numbers.push_back(options.pairs.size() + i);
    }
    const spherical_param::SphereSurfaceOptions surface_options{options.fit, morph_options.threads};
    const spherical_param::MorphResult result = spherical_param::morphSurfaces(
        {first.points, first_triangles, first.map.sphere, surface_options},
        {second.points, second_triangles, second.map.sphere, surface_options}, morph_options);
    for (const spherical_param::ImpossiblePair& pair : result.impossible)
      lost.push_back({numbers[pair.pair], pair.reason});
    std::sort(lost.begin(), lost.end(),
              [](const auto& one, const auto& other) { return one.pair < other.pair; });

    std::vector<pcl::Vertices> polygons(static_cast<std::size_t>(result.triangles.cols()));
    for (std::size_t t = 0; t < polygons.size(); ++t) {
      const auto triangle = result.triangles.col(static_cast<Eigen::Index>(t));
      polygons[t].vertices = {triangle[0], triangle[1], triangle[2]};
    }
    pcl::PointCloud<pcl::PointXYZ> cloud;
    cloud.resize(static_cast<std::size_t>(result.first.cols()));
    cloud.header = header;
    meshes.resize(static_cast<std::size_t>(frames));
    for (std::size_t frame = 0; frame < meshes.size(); ++frame) {
      const spherical_param::Positions positions = spherical_param::inBetween(
          result, static_cast<double>(frame) / static_cast<double>(frames - 1));
      for (std::size_t i = 0; i < cloud.size(); ++i)
        cloud[i].getVector3fMap() = positions.col(static_cast<Eigen::Index>(i)).cast<float>();
      pcl::toPCLPointCloud2(cloud, meshes[frame].cloud);
      meshes[frame].header = header;
      meshes[frame].polygons = polygons;
    }
  });
  if (callback_error)
    std::rethrow_exception(callback_error);
  if (!is_done)
    return false;
  output = std::move(meshes);
  if (impossible != nullptr)
    *impossible = std::move(lost);
  return true;
}

}  // namespace detail
}  // namespace pcl
