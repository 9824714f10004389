// Maps to the sphere, and what is made with them, whatever the type of the points.

#include <pcl/conversions.h>
#include <pcl/pcl_config.h>
#include <pcl/surface/spherical_param_morph.h>
#include <pcl/surface/spherical_param_remesh.h>
#include <pcl/surface/spherical_param_texture.h>

#include "spherical_param/errors.h"
#include "spherical_param/mesh_measures.h"

#include <algorithm>
#include <iterator>

namespace pcl {
namespace detail {
namespace {

using spherical_param::ImpossiblePair;
using spherical_param::Index;
using spherical_param::InvalidInput;
using spherical_param::Positions;

/// A cloud of points with normals, 3 x n each, without a header.
pcl::PCLPointCloud2 cloudOf(const Positions& points, const Positions& normals) {
  pcl::PointCloud<pcl::PointNormal> cloud;
  cloud.resize(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    cloud[i].getVector3fMap() = points.col(column).cast<float>();
    cloud[i].getNormalVector3fMap() = normals.col(column).cast<float>();
    // The curvature and what fills its place: PCL leaves these bytes as they are, and copies them.
    std::fill(std::begin(cloud[i].data_c), std::end(cloud[i].data_c), 0.0F);
  }
  pcl::PCLPointCloud2 result;
  pcl::toPCLPointCloud2(cloud, result);
  return result;
}

/// Triangles as polygons of the same vertices.
std::vector<pcl::Vertices> polygonsOf(const spherical_param::Triangles& triangles) {
  std::vector<pcl::Vertices> polygons(static_cast<std::size_t>(triangles.cols()));
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    const auto triangle = triangles.col(static_cast<Eigen::Index>(t));
    polygons[t].vertices = {triangle[0], triangle[1], triangle[2]};
  }
  return polygons;
}

/// Pairs of vertices, and where each comes from.
struct VertexPairs {
  std::vector<spherical_param::PointPair> pairs;
  std::vector<std::size_t> numbers;        ///< of each pair among those of the caller
  std::vector<ImpossiblePair> impossible;  ///< pairs of the caller that name no two vertices
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
    const Positions positions = spherical_param::inBetween(
        result, static_cast<double>(frame) / static_cast<double>(frames - 1));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud[i].getVector3fMap() = positions.col(static_cast<Eigen::Index>(i)).cast<float>();
    pcl::toPCLPointCloud2(cloud, meshes[frame].cloud);
    meshes[frame].header = header;
    meshes[frame].polygons = polygons;
  }
  return meshes;
}

pcl::TexMaterial materialOf(const std::string& image_file) {
  pcl::TexMaterial material;
  material.tex_name = "textured";
  material.tex_file = image_file;
  material.tex_Ka = {1.0F, 1.0F, 1.0F};
  material.tex_Kd = {1.0F, 1.0F, 1.0F};
  material.tex_Ks = {0.0F, 0.0F, 0.0F};
  material.tex_d = 1.0F;
  material.tex_Ns = 0.0F;
  material.tex_illum = 1;
  return material;
}

/// Three texture coordinates for each polygon, in their order.
void addCoordinates(const spherical_param::TextureAtlas& atlas, pcl::TextureMesh& mesh) {
  const Eigen::Index count = atlas.triangles.cols();
  mesh.tex_coordinates.resize(1);
  mesh.tex_coordinates[0].reserve(3 * static_cast<std::size_t>(count));
  for (Eigen::Index t = 0; t < count; ++t)
    for (Eigen::Index k = 0; k < 3; ++k)
      mesh.tex_coordinates[0].emplace_back(
          atlas.coordinates.col(atlas.coordinate_triangles(k, t)).cast<float>());
#if PCL_VERSION_COMPARE(>=, 1, 13, 0)
  mesh.tex_coord_indices.resize(1);
  mesh.tex_coord_indices[0].resize(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < mesh.tex_coord_indices[0].size(); ++t) {
    const auto first = static_cast<pcl::index_t>(3 * t);
    mesh.tex_coord_indices[0][t].vertices = {first, first + 1, first + 2};
  }
#endif
}

}  // namespace

void requireMap(const spherical_param::Surface& surface) {
  const std::string problem = "the mesh has no map to one sphere: it ";
  if (surface.has_certain_triangles_only)
    throw InvalidInput(problem + "is a tangle; call setTopology(TopologyMode::Sphere), which maps "
                                 "it as it is");
  if (surface.topology.components > 1)
    throw InvalidInput(problem + "is in " + std::to_string(surface.topology.components) +
                       " pieces; call setTopology(TopologyMode::Sphere), which joins them");
  const std::size_t count = surface.genus();
  if (count > 0)
    throw InvalidInput(problem + "has " + std::to_string(count) +
                       (count == 1 ? " handle" : " handles") +
                       "; call setHandles(HandleMode::None), which cuts them");
}

pcl::PolygonMesh remesh(const MappedMesh& mesh, const SphericalParamRemeshOptions& options,
                        int threads) {
  // The grid itself would accept as many as it can have.
  constexpr std::size_t max_points = std::size_t{1} << 29;
  if (options.points > max_points)
    throw InvalidInput("points = " + std::to_string(options.points) +
                       " is out of range; use up to 2^29");
  const std::size_t wanted =
      options.points > 0 ? options.points : static_cast<std::size_t>(mesh.points.cols());
  const spherical_param::SphereSurface surface(mesh.points, mesh.triangles, mesh.map.sphere,
                                               {options.fit, threads, mesh.map.caps});
  spherical_param::ResampledMesh resampled = spherical_param::resampleSurface(
      surface, spherical_param::makeGridSphere(
                   options.grid, spherical_param::gridFrequency(options.grid, wanted, surface)));
  spherical_param::untangle(surface, resampled, threads);
  pcl::PolygonMesh output;
  output.cloud = cloudOf(resampled.points, resampled.normals);
  output.polygons = polygonsOf(resampled.triangles);
  return output;
}

void checkFrames(int frames) {
  constexpr int max_frames = 10000;
  if (frames < 2 || frames > max_frames)
    throw InvalidInput("frames = " + std::to_string(frames) + " is out of range; use 2 to " +
                       std::to_string(max_frames));
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

pcl::TextureMesh textureMesh(const MappedMesh& mesh, const Positions& colors,
                             const SphericalParamTextureOptions& options, int threads,
                             spherical_param::TextureImage& image) {
  spherical_param::BakeOptions bake = options.bake;
  bake.threads = threads;
  const spherical_param::TextureAtlas atlas =
      spherical_param::makeTextureAtlas(mesh.triangles, mesh.map.sphere, options.atlas);
  spherical_param::TextureImage baked =
      colors.cols() > 0 ? spherical_param::bakeColors(atlas, colors, bake)
                        : spherical_param::bakeCheckerboard(atlas, mesh.map.sphere,
                                                            options.checkerboard_cells, bake);
  Positions normals = spherical_param::atCutVertices(
      atlas, spherical_param::areaWeightedNormals(mesh.points, mesh.triangles));
  for (Eigen::Index i = 0; i < normals.cols(); ++i)
    normals.col(i).stableNormalize();

  pcl::TextureMesh output;
  output.cloud = cloudOf(spherical_param::atCutVertices(atlas, mesh.points), normals);
  output.tex_polygons = {polygonsOf(atlas.triangles)};
  output.tex_materials = {materialOf(options.image_file)};
  addCoordinates(atlas, output);
  image = std::move(baked);
  return output;
}

}  // namespace detail
}  // namespace pcl
