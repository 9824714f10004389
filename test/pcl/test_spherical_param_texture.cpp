#include "clouds.h"

#include <pcl/TextureMesh.h>
#include <pcl/surface/spherical_param_texture.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

namespace {

using spherical_param::SphereChart;
using spherical_param::TextureImage;

class SphericalParamTexture : public test::Silent {
protected:
  SphericalParamTexture() { options.bake.height = 256; }

  template <typename PointT>
  bool texture(unsigned threads = 0) {
    pcl::SphericalParamReconstruction<PointT> reconstruction;
    reconstruction.setInputCloud(test::makeEllipsoid<PointT>(800));
    reconstruction.setNumberOfThreads(threads);
    return pcl::textureSphericalParam(reconstruction, mesh, image, options);
  }
  /// The colour of the image at texture coordinates.
  std::array<int, 3> pixelAt(const Eigen::Vector2f& place) const {
    const auto along = [](float fraction, int size) {
      return std::min(static_cast<int>(fraction * static_cast<float>(size)), size - 1);
    };
    const auto pixel = static_cast<std::size_t>(
        3 * (along(1.0F - place.y(), image.height) * image.width + along(place.x(), image.width)));
    return {image.pixels.at(pixel), image.pixels.at(pixel + 1), image.pixels.at(pixel + 2)};
  }

  pcl::SphericalParamTextureOptions options;
  pcl::TextureMesh mesh;
  TextureImage image;
};

TEST_F(SphericalParamTexture, IsAClosedMeshWhoseCoordinatesFindTheColoursOfThePoints) {
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap}) {
    options.atlas.chart = chart;
    options.image_file = "colors.png";
    ASSERT_TRUE(texture<pcl::PointXYZRGB>());
    EXPECT_EQ(mesh.header.frame_id, "scanner");
    ASSERT_EQ(mesh.tex_polygons.size(), 1U);
    ASSERT_EQ(mesh.tex_coordinates.size(), 1U);
    ASSERT_EQ(mesh.tex_materials.size(), 1U);
    EXPECT_EQ(mesh.tex_materials[0].tex_file, "colors.png");
    const test::Polygons& polygons = mesh.tex_polygons[0];
    const auto points = test::cloudOf<pcl::PointNormal>(mesh.cloud);
    EXPECT_TRUE(test::isSphere(polygons, points.size()));
    for (const pcl::PointNormal& point : points)
      EXPECT_GT(point.getNormalVector3fMap().dot(point.getVector3fMap().normalized()), 0.7F);
    ASSERT_EQ(mesh.tex_coordinates[0].size(), 3 * polygons.size());
    for (std::size_t i = 0; i < 3 * polygons.size(); ++i) {
      const auto vertex = static_cast<std::size_t>(polygons[i / 3].vertices[i % 3]);
      const Eigen::Vector2f place = mesh.tex_coordinates[0][i];
      ASSERT_TRUE(place.minCoeff() >= 0.0F && place.maxCoeff() <= 1.0F);
      const std::array<double, 3> wanted = test::colorAt(points[vertex].getVector3fMap());
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(pixelAt(place)[c], wanted[c], 10.0);
    }
  }
}

TEST_F(SphericalParamTexture, TakesColorsFromAllTypesThatHaveThemForAnyNumberOfThreads) {
  ASSERT_TRUE(texture<pcl::PointXYZRGB>(1));
  const TextureImage colors = image;
  const auto data = mesh.cloud.data;
  ASSERT_TRUE(texture<pcl::PointXYZRGB>(3));
  EXPECT_EQ(image.pixels, colors.pixels);
  EXPECT_EQ(mesh.cloud.data, data);
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
  options.checkerboard = true;
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  EXPECT_EQ(image.pixels, board.pixels);
}

TEST_F(SphericalParamTexture, AMeshWithHandlesIsCutInTheImageAlone) {
  pcl::SphericalParamReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(test::makeTorus(16));
  ASSERT_TRUE(pcl::textureSphericalParam(reconstruction, mesh, image, options));
  EXPECT_EQ(reconstruction.getResult().surface().genus(), 1U);
  const auto points = test::cloudOf<pcl::PointNormal>(mesh.cloud);
  const auto topology =
      spherical_param::checkTopology(test::trianglesOf(mesh.tex_polygons[0]), points.size());
  EXPECT_TRUE(topology.isSurface() && topology.closed);
  EXPECT_EQ(topology.genus, 1);
  ASSERT_GT(points.size(), 512U);
  for (std::size_t v = 0; v < 512; ++v) {
    const Eigen::Vector3f ring(points[v].x, points[v].y, 0.0F);
    const Eigen::Vector3f outward = points[v].getVector3fMap() - ring.normalized();
    EXPECT_GT(points[v].getNormalVector3fMap().dot(outward.normalized()), 0.9F);
  }
}

TEST_F(SphericalParamTexture, AFailureLeavesNothingButTheHeader) {
  const auto expect_failure = [this](const auto& spoil) {
    options = {};
    options.bake.height = 16;
    ASSERT_TRUE(texture<pcl::PointXYZ>());
    spoil(options);
    EXPECT_FALSE(texture<pcl::PointXYZ>());
    EXPECT_TRUE(mesh.cloud.data.empty() && mesh.tex_polygons.empty());
    EXPECT_TRUE(mesh.tex_coordinates.empty() && mesh.tex_materials.empty());
    EXPECT_TRUE(image.pixels.empty());
    EXPECT_EQ(image.width, 0);
    EXPECT_EQ(mesh.header.frame_id, "scanner");
  };
  expect_failure([](auto& o) { o.bake.height = 5; });
  expect_failure([](auto& o) { o.atlas.margin = 0.5; });
  expect_failure([](auto& o) { o.checkerboard_cells = 0; });
  pcl::SphericalParamReconstruction<pcl::PointXYZ> without_cloud;
  EXPECT_FALSE(pcl::textureSphericalParam(without_cloud, mesh, image));
  EXPECT_TRUE(mesh.tex_polygons.empty());
}

}  // namespace
