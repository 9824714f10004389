#include "mesh_conversion.h"

#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_morph.h>

#include "spherical_param/errors.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace pcl {
namespace detail {
namespace {

using spherical_param::ImpossiblePair;
using spherical_param::Index;

/// Pairs of vertices, and where each comes from.
struct VertexPairs {
  std::vector<spherical_param::PointPair> pairs;
  std::vector<std::size_t> numbers;        ///< of each pair among those of the caller
  std::vector<ImpossiblePair> impossible;  ///< pairs of the caller that are none of vertices
};

/// The vertex of a point of a cloud; -1: none.
Index vertexOf(const MorphShape& shape, pcl::index_t point) {
  const auto index = static_cast<std::size_t>(point);
  return point >= 0 && index < shape.vertex_of_point.size() ? shape.vertex_of_point[index] : -1;
}

VertexPairs findVertexPairs(const MorphShape& first, const MorphShape& second,
                            const SphericalParamMorphOptions& options) {
  VertexPairs result;
  for (std::size_t i = 0; i < options.pairs.size(); ++i) {
    const auto [first_point, second_point] = options.pairs[i];
    const Index first_vertex = vertexOf(first, first_point);
    const Index second_vertex = vertexOf(second, second_point);
    if (first_vertex >= 0 && second_vertex >= 0) {
      result.pairs.push_back({first_vertex, second_vertex});
      result.numbers.push_back(i);
    } else {
      const bool is_first = first_vertex < 0;
      result.impossible.push_back(
          {i, "point " + std::to_string(is_first ? first_point : second_point) + " of the " +
                  (is_first ? "first" : "second") + " cloud was not meshed"});
    }
  }
  for (std::size_t i = 0; i < options.morph.pairs.size(); ++i) {
    result.pairs.push_back(options.morph.pairs[i]);
    result.numbers.push_back(options.pairs.size() + i);
  }
  return result;
}

std::vector<pcl::PolygonMesh> framesOf(const spherical_param::MorphResult& result, int frames,
                                       const pcl::PCLHeader& header) {
  const std::vector<pcl::Vertices> polygons = polygonsOf(result.triangles);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.resize(static_cast<std::size_t>(result.first.cols()));
  cloud.header = header;
  std::vector<pcl::PolygonMesh> meshes(static_cast<std::size_t>(frames));
  for (std::size_t frame = 0; frame < meshes.size(); ++frame) {
    const spherical_param::Positions positions = spherical_param::inBetween(
        result, static_cast<double>(frame) / static_cast<double>(frames - 1));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud[i].getVector3fMap() = positions.col(static_cast<Eigen::Index>(i)).cast<float>();
    pcl::toPCLPointCloud2(cloud, meshes[frame].cloud);
    meshes[frame].header = header;
    meshes[frame].polygons = polygons;
  }
  return meshes;
}

}  // namespace

void checkFrames(int frames) {
  constexpr int max_frames = 10000;
  if (frames < 2 || frames > max_frames)
    throw spherical_param::InvalidInput("frames = " + std::to_string(frames) +
                                        " is out of range; use 2 to " + std::to_string(max_frames));
}

std::vector<pcl::PolygonMesh> morph(const MorphShape& first, const MorphShape& second, int frames,
                                    const SphericalParamMorphOptions& options,
                                    const spherical_param::Execution& execution,
                                    const pcl::PCLHeader& header,
                                    std::vector<ImpossiblePair>* impossible) {
  VertexPairs vertices = findVertexPairs(first, second, options);
  spherical_param::MorphOptions morph_options = options.morph;
  static_cast<spherical_param::Execution&>(morph_options) = execution;
  morph_options.pairs = vertices.pairs;
  const auto surface_of = [&](const MappedMesh& mesh) {
    return spherical_param::SphereSurface(mesh.points, mesh.triangles, mesh.map.sphere,
                                          {options.fit, execution.threads, mesh.map.caps});
  };
  const spherical_param::MorphResult result = spherical_param::morphSurfaces(
      surface_of(first.mesh), surface_of(second.mesh), morph_options);
  std::vector<pcl::PolygonMesh> meshes = framesOf(result, frames, header);
  for (const ImpossiblePair& pair : result.impossible)
    vertices.impossible.push_back({vertices.numbers[pair.pair], pair.reason});
  std::sort(vertices.impossible.begin(), vertices.impossible.end(),
            [](const auto& one, const auto& other) { return one.pair < other.pair; });
  if (impossible != nullptr)
    *impossible = std::move(vertices.impossible);
  return meshes;
}

}  // namespace detail
}  // namespace pcl
