#include "clouds.h"

#include <pcl/TextureMesh.h>
#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_morph.h>
#include <pcl/surface/spherical_param_remesh.h>
#include <pcl/surface/spherical_param_texture.h>
#include <spherical_param/errors.h>

#include <stdexcept>

namespace {

using namespace test;
using spherical_param::ImpossiblePair;
using spherical_param::SphereChart;
using spherical_param::SphereGrid;
using spherical_param::SphereMap;
using spherical_param::TextureImage;

class SphericalParamRemesh : public Silent {
protected:
  Reconstruction reconstruction = reconstructionOf(makeEllipsoid(1000));
  pcl::PolygonMesh mesh;
};

TEST_F(SphericalParamRemesh, OutputIsAClosedSphereOnTheEllipsoidWithNormals) {
  pcl::SphericalParamRemeshOptions options;
  options.grid = SphereGrid::Octahedral;
  for (const std::size_t points : {0U, 2500U}) {  // 0: as many as the mesh has
    options.points = points;
    ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh, options));
    const auto cloud = cloudOf<pcl::PointNormal>(mesh.cloud);
    ASSERT_EQ(cloud.size(), points == 0 ? 1026U : 2502U);  // 4 f^2 + 2
    EXPECT_TRUE(isSphere(mesh.polygons, cloud.size()));
    for (const pcl::PointNormal& p : cloud) {
      const Eigen::Vector3d on_sphere = p.getVector3fMap().cast<double>().cwiseQuotient(kAxes);
      const Eigen::Vector3d normal = p.getNormalVector3fMap().cast<double>();
      // Between 1000 points, the triangles are off the ellipsoid by (spacing / 2)^2 / (2 radius).
      EXPECT_NEAR(on_sphere.norm(), 1.0, 0.02);
      EXPECT_GT(normal.dot(on_sphere.cwiseQuotient(kAxes).normalized()), 0.95);
    }
    EXPECT_EQ(mesh.header.frame_id, "scanner");
    EXPECT_EQ(mesh.cloud.header.stamp, 42U);
  }
}

TEST_F(SphericalParamRemesh, MapBelongsToTheVerticesSmoothedOrNot) {
  Positions points;
  SphereMap map;
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  EXPECT_EQ(points,
            positionsOf(*reconstruction.getInputCloud(), reconstruction.getVertexIndices()));
  const spherical_param::MapDistortion distortion = spherical_param::measureMapDistortion(
      points, reconstruction.getResult().surface().triangles, map.sphere);
  EXPECT_EQ(distortion.flipped_triangles, 0);
  EXPECT_EQ(distortion.area.mean, map.distortion.area.mean);
  reconstruction.setSmoothing(3);
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  EXPECT_EQ(points, reconstruction.getResult().surface().points);
}

TEST_F(SphericalParamRemesh, MeshesWithHandlesAreRefusedAndCutOnesAreNot) {
  reconstruction.setInputCloud(makeTorus(24));
  Positions points;
  SphereMap map;
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(pcl::computeSphericalParamMap(reconstruction, points, map));
  const std::string message = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(message.find("it has 1 handle; call setHandles(HandleMode::None)"), std::string::npos)
      << message;
  EXPECT_EQ(points.cols() + map.sphere.cols(), 0);
  EXPECT_EQ(reconstruction.getResult().surface().genus(), 1U);
  EXPECT_TRUE(reconstruction.getSphereCoordinates()->empty());
  spherical_param::Surface tangle;
  tangle.has_certain_triangles_only = true;
  spherical_param::Surface pieces;
  pieces.topology.components = 2;
  for (const spherical_param::Surface& surface : {tangle, pieces})
    EXPECT_THROW(pcl::detail::requireMap(surface), spherical_param::InvalidInput);
  reconstruction.setHandles(spherical_param::HandleMode::None);
  ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh));
  EXPECT_TRUE(isSphere(mesh.polygons, mesh.cloud.width));
}

TEST_F(SphericalParamRemesh, FailureLeavesNothingAndExceptionsOfTheCallbackPass) {
  pcl::SphericalParamRemeshOptions wrong;
  wrong.points = std::size_t{1} << 40;
  pcl::SphericalParamRemeshOptions cancelled;
  cancelled.map.progress = [](const spherical_param::Progress&) { return false; };
  for (const pcl::SphericalParamRemeshOptions& options : {wrong, cancelled}) {
    mesh = staleMesh();
    EXPECT_FALSE(pcl::remeshSphericalParam(reconstruction, mesh, options));
    EXPECT_TRUE(mesh.polygons.empty() && mesh.cloud.data.empty());
  }
  cancelled.map.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::remeshSphericalParam(reconstruction, mesh, cancelled), std::logic_error);
  EXPECT_TRUE(mesh.polygons.empty());
  Reconstruction without_input;
  Positions points(3, 5);
  SphereMap map;
  map.sphere.resize(3, 5);
  EXPECT_FALSE(pcl::computeSphericalParamMap(without_input, points, map));
  EXPECT_EQ(points.cols(), 0);
  EXPECT_EQ(map.sphere.cols(), 0);
}

class SphericalParamMorph : public Silent {
protected:
  Cloud::Ptr first_cloud = makeEllipsoid(300);
  Cloud::Ptr second_cloud = makeEllipsoid(200, {0.7, 0.9, 2.0});
  Reconstruction first = reconstructionOf(first_cloud);
  Reconstruction second = reconstructionOf(second_cloud);
  std::vector<pcl::PolygonMesh> output;
};

TEST_F(SphericalParamMorph, FramesLeadFromOneToTheOtherAndPairsAreOneVertexOrSaidToBeImpossible) {
  first_cloud->push_back({kNan, 0.0F, 0.0F});
  pcl::SphericalParamMorphOptions options;
  options.pairs = {{10, 12}, {10, 40}, {300, 3}, {150, 90}, {-1, 7}, {0, 200}};
  options.morph.pairs = {{299, 199}, {1000, 0}};
  std::vector<ImpossiblePair> impossible;
  ASSERT_TRUE(pcl::morphSphericalParam(first, second, 3, output, options, &impossible));
  ASSERT_EQ(output.size(), 3U);
  for (const pcl::PolygonMesh& mesh : output) {
    EXPECT_TRUE(isSphere(mesh.polygons, cloudOf<PointXYZ>(mesh.cloud).size()));
    EXPECT_EQ(mesh.header.frame_id, "scanner");
    EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
  }
  std::vector<std::size_t> numbers;
  for (const ImpossiblePair& pair : impossible) {
    numbers.push_back(pair.pair);
    EXPECT_FALSE(pair.reason.empty());
  }
  EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 2, 4, 5, 7}));
  const Cloud from = cloudOf<PointXYZ>(output[0].cloud);
  const Cloud to = cloudOf<PointXYZ>(output[2].cloud);
  for (const auto& [one, other] : {options.pairs[0], options.pairs[3], {299, 199}}) {
    const PointXYZ& start = first_cloud->at(static_cast<std::size_t>(one));
    const PointXYZ& end = second_cloud->at(static_cast<std::size_t>(other));
    int count = 0;
    for (std::size_t v = 0; v < from.size(); ++v)
      if (from[v].getVector3fMap() == start.getVector3fMap() &&
          to[v].getVector3fMap() == end.getVector3fMap())
        ++count;
    EXPECT_EQ(count, 1);
  }
}

TEST_F(SphericalParamMorph, FailuresLeaveAnEmptyOutputAndExceptionsOfTheCallbackPass) {
  const auto expect_failure = [this](int frames,
                                     const pcl::SphericalParamMorphOptions& options = {}) {
    output.resize(3);
    EXPECT_FALSE(pcl::morphSphericalParam(first, second, frames, output, options));
    EXPECT_TRUE(output.empty());
  };
  for (const int frames : {1, 10001})
    expect_failure(frames);
  pcl::SphericalParamMorphOptions options;
  options.morph.progress = [](const spherical_param::Progress&) { return false; };
  expect_failure(2, options);
  options.morph.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::morphSphericalParam(first, second, 2, output, options), std::logic_error);
  EXPECT_TRUE(output.empty());
  second.setInputCloud(Cloud::Ptr());
  expect_failure(2);
}

class SphericalParamTexture : public Silent {
protected:
  SphericalParamTexture() { options.bake.height = 256; }

  template <typename PointT>
  bool texture() {
    pcl::SphericalParamReconstruction<PointT> reconstruction;
    reconstruction.setInputCloud(makeEllipsoid<PointT>(800));
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
    const Polygons& polygons = mesh.tex_polygons[0];
    const auto points = cloudOf<pcl::PointNormal>(mesh.cloud);
    EXPECT_TRUE(isSphere(polygons, points.size()));
    for (const pcl::PointNormal& point : points)
      EXPECT_GT(point.getNormalVector3fMap().dot(point.getVector3fMap().normalized()), 0.7F);
    ASSERT_EQ(mesh.tex_coordinates[0].size(), 3 * polygons.size());
    for (std::size_t i = 0; i < 3 * polygons.size(); ++i) {
      const auto vertex = static_cast<std::size_t>(polygons[i / 3].vertices[i % 3]);
      const Eigen::Vector2f place = mesh.tex_coordinates[0][i];
      ASSERT_TRUE(place.minCoeff() >= 0.0F && place.maxCoeff() <= 1.0F);
      const std::array<double, 3> wanted = colorAt(points[vertex].getVector3fMap());
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(pixelAt(place)[c], wanted[c], 10.0);
    }
  }
}

TEST_F(SphericalParamTexture, TakesColorsFromAllTypesThatHaveThem) {
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  const TextureImage colors = image;
  ASSERT_TRUE(texture<pcl::PointXYZRGBA>());
  EXPECT_EQ(image.pixels, colors.pixels);
  ASSERT_TRUE(texture<pcl::PointXYZRGBNormal>());
  EXPECT_EQ(image.pixels, colors.pixels);
  // Others get a checkerboard.
  ASSERT_TRUE(texture<pcl::PointXYZ>());
  const TextureImage board = image;
  EXPECT_NE(board.pixels, colors.pixels);
  options.checkerboard = true;
  ASSERT_TRUE(texture<pcl::PointXYZRGB>());
  EXPECT_EQ(image.pixels, board.pixels);
}

TEST_F(SphericalParamTexture, AFailureLeavesNothingButTheHeader) {
  ASSERT_TRUE(texture<pcl::PointXYZ>());
  options.atlas.margin = 0.5;
  EXPECT_FALSE(texture<pcl::PointXYZ>());
  EXPECT_TRUE(mesh.cloud.data.empty() && mesh.tex_polygons.empty());
  EXPECT_TRUE(mesh.tex_coordinates.empty() && mesh.tex_materials.empty());
  EXPECT_TRUE(image.pixels.empty());
  EXPECT_EQ(image.width, 0);
  EXPECT_EQ(mesh.header.frame_id, "scanner");
  Reconstruction without_cloud;
  EXPECT_FALSE(pcl::textureSphericalParam(without_cloud, mesh, image));
  EXPECT_TRUE(mesh.tex_polygons.empty());
}

}  // namespace
