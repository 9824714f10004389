#include "spherical_param/mesh_topology.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/surface/spherical_param_morph.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

using pcl::PointXYZ;
using spherical_param::ImpossiblePair;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;

/// Points spread evenly over an ellipsoid, in the order of a spiral.
pcl::PointCloud<PointXYZ>::Ptr makeEllipsoid(int count, const Eigen::Vector3d& axes) {
  pcl::PointCloud<PointXYZ>::Ptr cloud(new pcl::PointCloud<PointXYZ>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;  // the golden angle
    cloud->push_back({static_cast<float>(axes.x() * radius * std::cos(angle)),
                      static_cast<float>(axes.y() * radius * std::sin(angle)),
                      static_cast<float>(axes.z() * z)});
  }
  cloud->header.frame_id = "scanner";
  return cloud;
}

pcl::PointCloud<PointXYZ> cloudOf(const pcl::PolygonMesh& mesh) {
  pcl::PointCloud<PointXYZ> cloud;
  pcl::fromPCLPointCloud2(mesh.cloud, cloud);
  return cloud;
}

bool isSphere(const pcl::PolygonMesh& mesh) {
  spherical_param::Triangles triangles(3, static_cast<Eigen::Index>(mesh.polygons.size()));
  for (std::size_t t = 0; t < mesh.polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          mesh.polygons[t].vertices.at(corner);
  return spherical_param::checkTopology(triangles, cloudOf(mesh).size()).isSphere();
}

bool areSame(const PointXYZ& one, const PointXYZ& other) {
  return one.getVector3fMap() == other.getVector3fMap();
}

class SphericalParamMorph : public testing::Test {
protected:
  void SetUp() override {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    first.setInputCloud(first_cloud);
    second.setInputCloud(second_cloud);
  }

  pcl::PointCloud<PointXYZ>::Ptr first_cloud = makeEllipsoid(400, {1.5, 1.1, 0.8});
  pcl::PointCloud<PointXYZ>::Ptr second_cloud = makeEllipsoid(300, {0.7, 0.9, 2.0});
  Reconstruction first;
  Reconstruction second;
  std::vector<pcl::PolygonMesh> output;
};

TEST_F(SphericalParamMorph, FramesAreClosedAndLeadFromOneToTheOther) {
  ASSERT_TRUE(pcl::morphSphericalParam(first, second, 5, output));
  ASSERT_EQ(output.size(), 5U);
  for (const pcl::PolygonMesh& mesh : output) {
    EXPECT_TRUE(isSphere(mesh));
    EXPECT_EQ(mesh.header.frame_id, "scanner");
  }
  // All points of each cloud are vertices of the frame at its end.
  const auto contains = [](const pcl::PolygonMesh& mesh, const pcl::PointCloud<PointXYZ>& points) {
    const auto cloud = cloudOf(mesh);
    std::size_t found = 0;
    for (const PointXYZ& point : points)
      for (const PointXYZ& vertex : cloud)
        if (areSame(point, vertex)) {
          ++found;
          break;
        }
    return found == points.size();
  };
  EXPECT_TRUE(contains(output.front(), *first_cloud));
  EXPECT_TRUE(contains(output.back(), *second_cloud));
}

TEST_F(SphericalParamMorph, PairsAreOneVertexOrSaidToBeImpossible) {
  first_cloud->push_back({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F});
  pcl::SphericalParamMorphOptions options;
  options.pairs = {{10, 12}, {10, 40}, {400, 3}, {200, 140}, {-1, 7}, {0, 300}};
  options.morph.pairs = {{399, 299}, {1000, 0}};
  std::vector<ImpossiblePair> impossible;
  ASSERT_TRUE(pcl::morphSphericalParam(first, second, 2, output, options, &impossible));
  std::vector<std::size_t> numbers;
  for (const ImpossiblePair& pair : impossible) {
    numbers.push_back(pair.pair);
    EXPECT_FALSE(pair.reason.empty());
  }
  EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 2, 4, 5, 7}));
  const auto from = cloudOf(output[0]);
  const auto to = cloudOf(output[1]);
  for (const std::size_t i : {0U, 3U}) {
    int count = 0;
    for (std::size_t v = 0; v < from.size(); ++v)
      count +=
          areSame(from[v], first_cloud->at(static_cast<std::size_t>(options.pairs[i].first))) &&
                  areSame(to[v],
                          second_cloud->at(static_cast<std::size_t>(options.pairs[i].second)))
              ? 1
              : 0;
    EXPECT_EQ(count, 1);
  }
}

TEST_F(SphericalParamMorph, FailuresLeaveAnEmptyOutput) {
  const auto fails = [this](int frames, const pcl::SphericalParamMorphOptions& options) {
    output.resize(3);
    return !pcl::morphSphericalParam(first, second, frames, output, options) && output.empty();
  };
  for (const int frames : {-1, 0, 1, 10001})
    EXPECT_TRUE(fails(frames, {}));
  pcl::SphericalParamMorphOptions options;
  options.morph.connectivity = spherical_param::MorphConnectivity::Resampled;
  options.morph.samples = 3;
  EXPECT_TRUE(fails(2, options));
  options = {};
  options.morph.progress = [](const spherical_param::Progress&) { return false; };
  EXPECT_TRUE(fails(2, options));
  options = {};
  options.map.area_weight = -1.0;
  EXPECT_TRUE(fails(2, options));
  second.setInputCloud(pcl::PointCloud<PointXYZ>::Ptr());
  EXPECT_TRUE(fails(2, {}));
  second.setInputCloud(second_cloud);
  first.setInputCloud(pcl::PointCloud<PointXYZ>::Ptr(new pcl::PointCloud<PointXYZ>));
  EXPECT_TRUE(fails(2, {}));
}

TEST_F(SphericalParamMorph, ExceptionsOfTheProgressCallbackArePassedOn) {
  pcl::SphericalParamMorphOptions options;
  options.morph.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::morphSphericalParam(first, second, 2, output, options), std::logic_error);
  EXPECT_TRUE(output.empty());
}

}  // namespace
