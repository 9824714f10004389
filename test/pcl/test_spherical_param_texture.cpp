#include "spherical_param/mesh_topology.h"

#include <pcl/TextureMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_texture.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>

namespace {

using spherical_param::SphereChart;
using spherical_param::TextureImage;
using spherical_param::Triangles;

template <typename PointT>
using Reconstruction = pcl::SphericalParamReconstruction<PointT>;

/// Colours that change slowly.
std::array<double, 3> colorAt(const Eigen::Vector3f& point) {
  return {127.0 + 80.0 * static_cast<double>(point.x()),
          127.0 + 80.0 * static_cast<double>(point.y()),
          127.0 + 80.0 * static_cast<double>(point.z())};
}

/// Points spread evenly over an ellipsoid, in the order of a spiral.
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;  // the golden angle
    PointT point{};
    point.x = static_cast<float>(1.5 * radius * std::cos(angle));
    point.y = static_cast<float>(1.1 * radius * std::sin(angle));
    point.z = static_cast<float>(0.8 * z);
    if constexpr (pcl::traits::has_color<PointT>::value) {
      const std::array<double, 3> color = colorAt(point.getVector3fMap());
      point.r = static_cast<std::uint8_t>(color[0]);
      point.g = static_cast<std::uint8_t>(color[1]);
      point.b = static_cast<std::uint8_t>(color[2]);
      point.a = 7;
    }
    cloud->push_back(point);
  }
  cloud->header.frame_id = "scanner";
  cloud->header.stamp = 42;
  return cloud;
}

class SphericalParamTexture : public testing::Test {
protected:
  void SetUp() override { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }

  template <typename PointT>
  bool texture(const pcl::SphericalParamTextureOptions& options = small(), int threads = 0) {
    Reconstruction<PointT> reconstruction;
    reconstruction.setInputCloud(makeEllipsoid<PointT>(800));
    reconstruction.setNumberOfThreads(static_cast<unsigned>(threads));
    return pcl::textureSphericalParam(reconstruction, mesh, image, options);
  }
  static pcl::SphericalParamTextureOptions small() {
    pcl::SphericalParamTextureOptions options;
    options.bake.height = 256;
    return options;
  }
  void expectEmpty() const {
    EXPECT_TRUE(mesh.cloud.data.empty());
    EXPECT_TRUE(mesh.tex_polygons.empty());
    EXPECT_TRUE(mesh.tex_coordinates.empty());
    EXPECT_TRUE(mesh.tex_materials.empty());
    EXPECT_TRUE(image.pixels.empty());
    EXPECT_EQ(image.width, 0);
  }
  pcl::PointCloud<pcl::PointNormal> cloud() const {
    pcl::PointCloud<pcl::PointNormal> points;
    pcl::fromPCLPointCloud2(mesh.cloud, points);
    return points;
  }

  pcl::TextureMesh mesh;
  TextureImage image;
};

TEST_F(SphericalParamTexture, IsAClosedMeshWithThreeCoordinatesForEachPolygon) {
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap}) {
    pcl::SphericalParamTextureOptions options = small();
    options.atlas.chart = chart;
    options.image_file = "colors.png";
    ASSERT_TRUE(texture<pcl::PointXYZRGB>(options));
    EXPECT_EQ(mesh.header.frame_id, "scanner");
    EXPECT_EQ(mesh.header.stamp, 42U);
    ASSERT_EQ(mesh.tex_polygons.size(), 1U);
    ASSERT_EQ(mesh.tex_coordinates.size(), 1U);
    ASSERT_EQ(mesh.tex_materials.size(), 1U);
    EXPECT_EQ(mesh.tex_materials[0].tex_file, "colors.png");
    const auto& polygons = mesh.tex_polygons[0];
    const auto points = cloud();
    ASSERT_EQ(mesh.tex_coordinates[0].size(), 3 * polygons.size());
    Triangles triangles(3, static_cast<Eigen::Index>(polygons.size()));
    for (std::size_t t = 0; t < polygons.size(); ++t) {
      ASSERT_EQ(polygons[t].vertices.size(), 3U);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto vertex = polygons[t].vertices[k];
        triangles(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) = vertex;
        // The image has the colour of the points.
        const Eigen::Vector2f place = mesh.tex_coordinates[0][3 * t + k];
        ASSERT_TRUE(place.minCoeff() >= 0.0F && place.maxCoeff() <= 1.0F);
        const int x = std::min(static_cast<int>(place.x() * static_cast<float>(image.width)),
                               image.width - 1);
        const int y =
            std::min(static_cast<int>((1.0F - place.y()) * static_cast<float>(image.height)),
                     image.height - 1);
        const std::array<double, 3> wanted =
            colorAt(points[static_cast<std::size_t>(vertex)].getVector3fMap());
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(image.pixels[static_cast<std::size_t>(3 * (y * image.width + x)) + c],
                      wanted[c], 10.0);
      }
    }
    EXPECT_TRUE(spherical_param::checkTopology(triangles, points.size()).isSphere());
    for (const pcl::PointNormal& point : points)
      EXPECT_GT(point.getNormalVector3fMap().dot(point.getVector3fMap().normalized()), 0.7F);
  }
}

TEST_F(SphericalParamTexture, TakesColorsFromAllTypesThatHaveThem) {
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  const TextureImage colors = image;
  ASSERT_TRUE(texture<pcl::PointXYZRGBA>());
  EXPECT_EQ(image.pixels, colors.pixels);
  ASSERT_TRUE(texture<pcl::PointXYZRGBNormal>());
  EXPECT_EQ(image.pixels, colors.pixels);
  // Others get a checkerboard: light and dark for each octant.
  ASSERT_TRUE(texture<pcl::PointXYZ>());
  const TextureImage board = image;
  std::set<std::array<std::uint8_t, 3>> seen;
  for (std::size_t i = 0; i < board.pixels.size(); i += 3)
    seen.insert({board.pixels[i], board.pixels[i + 1], board.pixels[i + 2]});
  EXPECT_EQ(seen.size(), 16U);
  pcl::SphericalParamTextureOptions options = small();
  options.checkerboard = true;
  ASSERT_TRUE(texture<pcl::PointXYZRGB>(options));
  EXPECT_EQ(image.pixels, board.pixels);
}

TEST_F(SphericalParamTexture, IsTheSameForAnyNumberOfThreads) {
  ASSERT_TRUE(texture<pcl::PointXYZRGB>(small(), 1));
  const TextureImage one = image;
  const auto data = mesh.cloud.data;
  for (const int threads : {2, 3}) {
    ASSERT_TRUE(texture<pcl::PointXYZRGB>(small(), threads));
    EXPECT_EQ(image.pixels, one.pixels);
    EXPECT_EQ(mesh.cloud.data, data);
  }
}

TEST_F(SphericalParamTexture, AFailureLeavesNothingOfTheLastResult) {
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  pcl::SphericalParamTextureOptions options = small();
  options.bake.height = 5;
  EXPECT_FALSE(texture<pcl::PointXYZRGB>(options));
  expectEmpty();
  EXPECT_EQ(mesh.header.frame_id, "scanner");
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  options = small();
  options.atlas.margin = 0.5;
  EXPECT_FALSE(texture<pcl::PointXYZRGB>(options));
  expectEmpty();
  ASSERT_TRUE(texture<pcl::PointXYZ>());
  options = small();
  options.checkerboard_cells = 0;
  EXPECT_FALSE(texture<pcl::PointXYZ>(options));
  expectEmpty();
  Reconstruction<pcl::PointXYZ> without_cloud;
  ASSERT_TRUE(texture<pcl::PointXYZ>());
  EXPECT_FALSE(pcl::textureSphericalParam(without_cloud, mesh, image));
  expectEmpty();
}

}  // namespace
