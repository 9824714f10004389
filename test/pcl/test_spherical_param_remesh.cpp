#include "spherical_param/mesh_topology.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_map.h>
#include <pcl/surface/spherical_param_remesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

using pcl::PointXYZ;
using spherical_param::Positions;
using spherical_param::SphereGrid;
using spherical_param::SphereMap;
using spherical_param::Triangles;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;

const Eigen::Vector3d axes(1.5, 1.1, 0.8);

/// Points spread evenly over an ellipsoid, in the order of a spiral.
template <typename PointT = PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;  // the golden angle
    PointT point{};
    point.x = static_cast<float>(axes.x() * radius * std::cos(angle));
    point.y = static_cast<float>(axes.y() * radius * std::sin(angle));
    point.z = static_cast<float>(axes.z() * z);
    cloud->push_back(point);
  }
  cloud->header.frame_id = "scanner";
  cloud->header.stamp = 42;
  return cloud;
}

Triangles trianglesOf(const pcl::PolygonMesh& mesh) {
  Triangles triangles(3, static_cast<Eigen::Index>(mesh.polygons.size()));
  for (std::size_t t = 0; t < mesh.polygons.size(); ++t) {
    EXPECT_EQ(mesh.polygons[t].vertices.size(), 3U);
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          mesh.polygons[t].vertices[corner];
  }
  return triangles;
}

pcl::PointCloud<pcl::PointNormal> cloudOf(const pcl::PolygonMesh& mesh) {
  pcl::PointCloud<pcl::PointNormal> cloud;
  pcl::fromPCLPointCloud2(mesh.cloud, cloud);
  return cloud;
}

class SphericalParamRemesh : public testing::Test {
protected:
  void SetUp() override {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    reconstruction.setInputCloud(makeEllipsoid(1000));
  }

  Reconstruction reconstruction;
  pcl::PolygonMesh mesh;
};

TEST_F(SphericalParamRemesh, OutputIsAClosedSphereOnTheEllipsoidWithNormals) {
  for (const SphereGrid grid : {SphereGrid::Icosahedral, SphereGrid::Octahedral}) {
    pcl::SphericalParamRemeshOptions options;
    options.grid = grid;
    options.points = 2500;
    ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh, options));
    const auto cloud = cloudOf(mesh);
    ASSERT_EQ(cloud.size(),
              spherical_param::gridVertices(grid, spherical_param::gridFrequency(grid, 2500)));
    const Triangles triangles = trianglesOf(mesh);
    EXPECT_TRUE(spherical_param::checkTopology(triangles, cloud.size()).isSphere());
    Positions points(3, static_cast<Eigen::Index>(cloud.size()));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3d point = cloud[i].getVector3fMap().cast<double>();
      const Eigen::Vector3d normal = cloud[i].getNormalVector3fMap().cast<double>();
      points.col(static_cast<Eigen::Index>(i)) = point;
      // Between 1000 points, the triangles are off the ellipsoid by (spacing / 2)^2 / (2 radius).
      EXPECT_NEAR(point.cwiseQuotient(axes).norm(), 1.0, 0.02);
      const Eigen::Vector3d outward = point.cwiseQuotient(axes).cwiseQuotient(axes).normalized();
      EXPECT_GT(normal.dot(outward), 0.95);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    }
    EXPECT_GT(spherical_param::signedVolume(points, triangles), 0.0);
  }
}

TEST_F(SphericalParamRemesh, HasAsManyPointsAsTheMeshUnlessToldAndTheHeaderOfTheInput) {
  ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh));
  const SphereGrid grid = SphereGrid::Icosahedral;
  EXPECT_EQ(cloudOf(mesh).size(),
            spherical_param::gridVertices(grid, spherical_param::gridFrequency(grid, 1000)));
  EXPECT_EQ(mesh.header.frame_id, "scanner");
  EXPECT_EQ(mesh.header.stamp, 42U);
  EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
  EXPECT_EQ(reconstruction.getResult().vertexCount(), 1000U);
}

TEST_F(SphericalParamRemesh, MapIsOneToOneAndBelongsToTheVertices) {
  Positions points;
  SphereMap map;
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  ASSERT_EQ(points.cols(), 1000);
  ASSERT_EQ(map.sphere.cols(), 1000);
  const spherical_param::MapDistortion distortion = spherical_param::measureMapDistortion(
      points, reconstruction.getResult().triangles, map.sphere);
  EXPECT_EQ(distortion.flipped_triangles, 0);
  EXPECT_EQ(distortion.area.mean, map.distortion.area.mean);
  const auto& cloud = *reconstruction.getInputCloud();
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto index = static_cast<std::size_t>(reconstruction.getVertexIndices()[i]);
    EXPECT_EQ(points.col(static_cast<Eigen::Index>(i)),
              cloud[index].getVector3fMap().cast<double>());
  }
}

TEST_F(SphericalParamRemesh, SmoothedPointsAreMappedIfThereAreAny) {
  reconstruction.setSmoothing(3);
  Positions points;
  SphereMap map;
  ASSERT_TRUE(pcl::computeSphericalParamMap(reconstruction, points, map));
  EXPECT_EQ(points, reconstruction.getResult().smoothed);
}

TEST_F(SphericalParamRemesh, SameForAnyNumberOfThreads) {
  ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, mesh));
  for (const unsigned threads : {1U, 3U}) {
    reconstruction.setNumberOfThreads(threads);
    pcl::PolygonMesh other;
    ASSERT_TRUE(pcl::remeshSphericalParam(reconstruction, other));
    EXPECT_EQ(other.cloud.data, mesh.cloud.data) << threads;
    EXPECT_EQ(trianglesOf(other), trianglesOf(mesh)) << threads;
  }
}

TEST_F(SphericalParamRemesh, WorksForPointsWithMoreFields) {
  pcl::SphericalParamReconstruction<pcl::PointXYZRGBNormal> colored;
  colored.setInputCloud(makeEllipsoid<pcl::PointXYZRGBNormal>(300));
  EXPECT_TRUE(pcl::remeshSphericalParam(colored, mesh));
}

TEST_F(SphericalParamRemesh, FailureLeavesNothingAndThrowsNothing) {
  const auto expect_failure = [&](Reconstruction& failing,
                                  const pcl::SphericalParamRemeshOptions& options) {
    mesh.polygons.resize(7);
    mesh.cloud.data.resize(7);
    EXPECT_FALSE(pcl::remeshSphericalParam(failing, mesh, options));
    EXPECT_TRUE(mesh.polygons.empty());
    EXPECT_TRUE(mesh.cloud.data.empty());
  };
  Reconstruction without_input;
  expect_failure(without_input, {});
  Reconstruction few_points;
  few_points.setInputCloud(makeEllipsoid(3));
  expect_failure(few_points, {});
  pcl::SphericalParamRemeshOptions bad_weight;
  bad_weight.map.area_weight = std::numeric_limits<double>::quiet_NaN();
  expect_failure(reconstruction, bad_weight);
  pcl::SphericalParamRemeshOptions too_many;
  too_many.points = std::size_t{1} << 40;
  expect_failure(reconstruction, too_many);

  Positions points(3, 5);
  SphereMap map;
  map.sphere.resize(3, 5);
  EXPECT_FALSE(pcl::computeSphericalParamMap(without_input, points, map));
  EXPECT_EQ(points.cols(), 0);
  EXPECT_EQ(map.sphere.cols(), 0);
}

TEST_F(SphericalParamRemesh, ProgressCanCancelAndItsExceptionsArePassedOn) {
  pcl::SphericalParamRemeshOptions options;
  options.map.progress = [](const spherical_param::Progress&) { return false; };
  EXPECT_FALSE(pcl::remeshSphericalParam(reconstruction, mesh, options));
  EXPECT_TRUE(mesh.polygons.empty());
  options.map.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::remeshSphericalParam(reconstruction, mesh, options), std::logic_error);
  EXPECT_TRUE(mesh.polygons.empty());
}

}  // namespace
