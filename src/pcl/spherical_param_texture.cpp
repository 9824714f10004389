#include <pcl/conversions.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_texture.h>

#include "spherical_param/mesh_measures.h"

#include <Eigen/Geometry>

#include <cstddef>
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

}  // namespace

bool textureMesh(const spherical_param::Positions& points,
                 const spherical_param::Triangles& triangles,
                 const spherical_param::Positions& sphere, const spherical_param::Positions& colors,
                 const SphericalParamTextureOptions& options, pcl::TextureMesh& output,
                 spherical_param::TextureImage& image) {
  pcl::TextureMesh mesh;
  spherical_param::TextureImage texture;
  const bool is_done = runCore("textureSphericalParam", [&] {
    mesh.header = output.header;
    const spherical_param::TextureAtlas atlas =
        spherical_param::makeTextureAtlas(triangles, sphere, options.atlas);
    texture = colors.cols() > 0 ? spherical_param::bakeColors(atlas, colors, options.bake)
                                : spherical_param::bakeCheckerboard(
                                      atlas, sphere, options.checkerboard_cells, options.bake);

    const Eigen::MatrixXd places = spherical_param::atCutVertices(atlas, points);
    const Eigen::MatrixXd normals = spherical_param::atCutVertices(
        atlas, spherical_param::areaWeightedNormals(points, triangles));
    pcl::PointCloud<pcl::PointNormal> cloud;
    cloud.resize(atlas.vertices.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      cloud[i].getVector3fMap() = places.col(column).cast<float>();
      cloud[i].getNormalVector3fMap() = normals.col(column).stableNormalized().cast<float>();
    }
    cloud.header = mesh.header;
    pcl::toPCLPointCloud2(cloud, mesh.cloud);

    const auto count = static_cast<std::size_t>(atlas.triangles.cols());
    mesh.tex_materials = {materialOf(options.image_file)};
    mesh.tex_polygons.resize(1);
    mesh.tex_coordinates.resize(1);
    mesh.tex_polygons[0].resize(count);
    mesh.tex_coordinates[0].reserve(3 * count);
#if PCL_VERSION_COMPARE(>=, 1, 13, 0)
    mesh.tex_coord_indices.resize(1);
    mesh.tex_coord_indices[0].resize(count);
#endif
    for (std::size_t t = 0; t < count; ++t) {
      const auto column = static_cast<Eigen::Index>(t);
      const auto triangle = atlas.triangles.col(column);
      mesh.tex_polygons[0][t].vertices = {triangle[0], triangle[1], triangle[2]};
      for (Eigen::Index k = 0; k < 3; ++k)
        mesh.tex_coordinates[0].emplace_back(
            atlas.coordinates.col(atlas.coordinate_triangles(k, column)).cast<float>());
#if PCL_VERSION_COMPARE(>=, 1, 13, 0)
      const auto first = static_cast<pcl::index_t>(3 * t);
      mesh.tex_coord_indices[0][t].vertices = {first, first + 1, first + 2};
#endif
    }
  });
  if (is_done) {
    output = std::move(mesh);
    image = std::move(texture);
  }
  return is_done;
}

}  // namespace detail
}  // namespace pcl
