#include "clouds.h"

#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_remesh.h>
#include <spherical_param/errors.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace {

using pcl::PointXYZ;
using spherical_param::Positions;
using spherical_param::SphereGrid;
using spherical_param::SphereMap;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;

class SphericalParamRemesh : public test::Silent {
protected:
  void SetUp() override {
    Silent::SetUp();
    reconstruction.setInputCloud(test::makeEllipsoid(1000));
  }

  Reconstruction reconstruction;
  pcl::PolygonMesh mesh;
};

TEST_F(SphericalParamRemesh, OutputIsAClosedSphereOnTheEllipsoidWithNormals) {
  for (const SphereGrid grid : {SphereGrid::Icosahedral, SphereGrid::Octahedral})
    for (const std::size_t points : {0U, 2500U}) {  // 0: as many as the mesh has
      pcl::SphericalParamRemeshOptions options;
      options.grid = grid;
      options.points = points;
      ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh, options));
      const auto cloud = test::cloudOf<pcl::PointNormal>(mesh.cloud);
      const std::size_t wanted = points == 0 ? 1000 : points;
      ASSERT_EQ(cloud.size(),
                spherical_param::gridVertices(grid, spherical_param::gridFrequency(grid, wanted)));
      EXPECT_TRUE(test::isSphere(mesh.polygons, cloud.size()));
      for (const pcl::PointNormal& p : cloud) {
        const Eigen::Vector3d on_sphere =
            p.getVector3fMap().cast<double>().cwiseQuotient(test::kAxes);
        const Eigen::Vector3d normal = p.getNormalVector3fMap().cast<double>();
        // Between 1000 points, the triangles are off the ellipsoid by (spacing / 2)^2 / (2 radius).
        EXPECT_NEAR(on_sphere.norm(), 1.0, 0.02);
        EXPECT_GT(normal.dot(on_sphere.cwiseQuotient(test::kAxes).normalized()), 0.95);
        EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
      }
      EXPECT_EQ(mesh.header.frame_id, "scanner");
      EXPECT_EQ(mesh.cloud.header.stamp, 42U);
    }
}

TEST_F(SphericalParamRemesh, OpeningsStayOpen) {
  pcl::PointCloud<PointXYZ>::Ptr half(new pcl::PointCloud<PointXYZ>);
  const auto whole = test::makeEllipsoid(3000);
  for (const PointXYZ& point : *whole)
    if (point.z < 0.0F)
      half->push_back(point);
  reconstruction.setInputCloud(half);
  reconstruction.setSurface(spherical_param::SurfaceMode::Open);
  ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh));
  const auto cloud = test::cloudOf<pcl::PointNormal>(mesh.cloud);
  EXPECT_NEAR(static_cast<double>(cloud.size()), static_cast<double>(half->size()),
              0.1 * static_cast<double>(half->size()));
  for (const pcl::PointNormal& point : cloud)
    EXPECT_LT(point.z, 0.05F);
}

TEST_F(SphericalParamRemesh, MapIsOneToOneAndBelongsToTheVerticesSmoothedOrNot) {
  Positions points;
  SphereMap map;
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  ASSERT_EQ(points.cols(), 1000);
  const spherical_param::MapDistortion distortion = spherical_param::measureMapDistortion(
      points, reconstruction.getResult().surface().triangles, map.sphere);
  EXPECT_EQ(distortion.flipped_triangles, 0);
  EXPECT_EQ(distortion.area.mean, map.distortion.area.mean);
  for (std::size_t v = 0; v < 1000; ++v) {
    const auto index = static_cast<std::size_t>(reconstruction.getVertexIndices()[v]);
    EXPECT_EQ(points.col(static_cast<Eigen::Index>(v)),
              (*reconstruction.getInputCloud())[index].getVector3fMap().cast<double>());
  }
  reconstruction.setSmoothing(3);
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  EXPECT_EQ(points, reconstruction.getResult().surface().smoothed);
}

TEST_F(SphericalParamRemesh, MeshesWithHandlesAreRefusedAndCutOnesAreNot) {
  reconstruction.setInputCloud(test::makeTorus(24));
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
  EXPECT_THROW(pcl::detail::requireSphere(tangle), spherical_param::InvalidInput);
  reconstruction.setHandles(spherical_param::HandleMode::None);
  ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh));
  EXPECT_TRUE(test::isSphere(mesh.polygons, mesh.cloud.width));
  EXPECT_EQ(reconstruction.getSphereCoordinates()->size(), 1152U);
}

TEST_F(SphericalParamRemesh, FailureLeavesNothingAndExceptionsOfTheCallbackPass) {
  const auto expect_failure = [&](Reconstruction& failing,
                                  const pcl::SphericalParamRemeshOptions& options) {
    mesh.polygons.resize(7);
    mesh.cloud.data.resize(7);
    EXPECT_FALSE(pcl::remeshSphericalParam(failing, mesh, options));
    EXPECT_TRUE(mesh.polygons.empty() && mesh.cloud.data.empty());
  };
  Reconstruction without_input;
  expect_failure(without_input, {});
  pcl::SphericalParamRemeshOptions options;
  options.map.area_weight = std::numeric_limits<double>::quiet_NaN();
  expect_failure(reconstruction, options);
  options = {};
  options.points = std::size_t{1} << 40;
  expect_failure(reconstruction, options);
  options = {};
  options.map.progress = [](const spherical_param::Progress&) { return false; };
  expect_failure(reconstruction, options);
  options.map.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::remeshSphericalParam(reconstruction, mesh, options), std::logic_error);
  EXPECT_TRUE(mesh.polygons.empty());
  Positions points(3, 5);
  SphereMap map;
  map.sphere.resize(3, 5);
  EXPECT_FALSE(pcl::computeSphericalParamMap(without_input, points, map));
  EXPECT_EQ(points.cols(), 0);
  EXPECT_EQ(map.sphere.cols(), 0);
}

}  // namespace
