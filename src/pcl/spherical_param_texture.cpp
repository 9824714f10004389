#include "mesh_conversion.h"

#include <pcl/pcl_config.h>
#include <pcl/surface/spherical_param_texture.h>

#include "spherical_param/mesh_measures.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <string>
#include <utility>

namespace pcl {
namespace detail {
namespace {

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

pcl::TextureMesh textureMesh(const MappedMesh& mesh, const spherical_param::Positions& colors,
                             const SphericalParamTextureOptions& options, int threads,
                             spherical_param::TextureImage& image) {
  spherical_param::BakeOptions bake = options.bake;
  bake.threads = threads;
  spherical_param::TextureAtlas atlas =
      spherical_param::makeTextureAtlas(mesh.triangles, mesh.map.sphere, options.atlas);
  spherical_param::TextureImage baked =
      colors.cols() > 0
          ? spherical_param::bakeColors(
                atlas, spherical_param::Positions(colors(Eigen::all, mesh.vertex_of)), bake)
          : spherical_param::bakeCheckerboard(atlas, mesh.map.sphere, options.checkerboard_cells,
                                              bake);
  atlas = spherical_param::joinCuts(std::move(atlas), mesh);
  spherical_param::Triangles triangles = mesh.triangles;
  for (spherical_param::Index& v : triangles.reshaped())
    v = mesh.vertex_of[static_cast<std::size_t>(v)];
  const spherical_param::Positions points = mesh.points.leftCols(triangles.maxCoeff() + 1);
  spherical_param::Positions normals = spherical_param::atCutVertices(
      atlas, spherical_param::areaWeightedNormals(points, triangles));
  for (Eigen::Index i = 0; i < normals.cols(); ++i)
    normals.col(i).stableNormalize();

  pcl::TextureMesh output;
  output.cloud = cloudOf(spherical_param::atCutVertices(atlas, points), normals);
  output.tex_polygons = {polygonsOf(atlas.triangles)};
  output.tex_materials = {materialOf(options.image_file)};
  addCoordinates(atlas, output);
  image = std::move(baked);
  return output;
}

}  // namespace detail
}  // namespace pcl
