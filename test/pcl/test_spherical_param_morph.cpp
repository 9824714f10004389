#include "clouds.h"

#include <pcl/surface/spherical_param_morph.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

using pcl::PointXYZ;
using spherical_param::ImpossiblePair;
using Cloud = pcl::PointCloud<PointXYZ>;
using Reconstruction = pcl::SphericalParamReconstruction<PointXYZ>;

bool areSame(const PointXYZ& one, const PointXYZ& other) {
  return one.getVector3fMap() == other.getVector3fMap();
}

class SphericalParamMorph : public test::Silent {
protected:
  void SetUp() override {
    Silent::SetUp();
    first.setInputCloud(first_cloud);
    second.setInputCloud(second_cloud);
  }

  Cloud::Ptr first_cloud = test::makeEllipsoid(300);
  Cloud::Ptr second_cloud = test::makeEllipsoid(200, {0.7, 0.9, 2.0});
  Reconstruction first;
  Reconstruction second;
  std::vector<pcl::PolygonMesh> output;
};

TEST_F(SphericalParamMorph, FramesAreClosedAndLeadFromOneToTheOther) {
  ASSERT_TRUE(pcl::morphSphericalParam(first, second, 3, output));
  ASSERT_EQ(output.size(), 3U);
  for (const pcl::PolygonMesh& mesh : output) {
    EXPECT_TRUE(test::isSphere(mesh.polygons, test::cloudOf<PointXYZ>(mesh.cloud).size()));
    EXPECT_EQ(mesh.header.frame_id, "scanner");
    EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
  }
  const auto has_all = [](const pcl::PolygonMesh& mesh, const Cloud& points) {
    const Cloud cloud = test::cloudOf<PointXYZ>(mesh.cloud);
    return std::all_of(points.begin(), points.end(), [&](const PointXYZ& point) {
      return std::any_of(cloud.begin(), cloud.end(),
                         [&](const PointXYZ& vertex) { return areSame(point, vertex); });
    });
  };
  EXPECT_TRUE(has_all(output.front(), *first_cloud));
  EXPECT_TRUE(has_all(output.back(), *second_cloud));
}

TEST_F(SphericalParamMorph, PairsOfPointsAreOneVertexOrSaidToBeImpossible) {
  first_cloud->push_back({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F});
  pcl::SphericalParamMorphOptions options;
  options.pairs = {{10, 12}, {10, 40}, {300, 3}, {150, 90}, {-1, 7}, {0, 200}};
  options.morph.pairs = {{299, 199}, {1000, 0}};
  std::vector<ImpossiblePair> impossible;
  ASSERT_TRUE(pcl::morphSphericalParam(first, second, 2, output, options, &impossible));
  std::vector<std::size_t> numbers;
  for (const ImpossiblePair& pair : impossible) {
    numbers.push_back(pair.pair);
    EXPECT_FALSE(pair.reason.empty());
  }
  EXPECT_EQ(numbers, (std::vector<std::size_t>{1, 2, 4, 5, 7}));
  const Cloud from = test::cloudOf<PointXYZ>(output[0].cloud);
  const Cloud to = test::cloudOf<PointXYZ>(output[1].cloud);
  for (const auto& [one, other] : {options.pairs[0], options.pairs[3], {299, 199}}) {
    int count = 0;
    for (std::size_t v = 0; v < from.size(); ++v)
      count += areSame(from[v], first_cloud->at(static_cast<std::size_t>(one))) &&
                       areSame(to[v], second_cloud->at(static_cast<std::size_t>(other)))
                   ? 1
                   : 0;
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
  for (const int frames : {-1, 0, 1, 10001})
    expect_failure(frames);
  pcl::SphericalParamMorphOptions options;
  options.map.area_weight = -1.0;
  expect_failure(2, options);
  options = {};
  options.morph.progress = [](const spherical_param::Progress&) { return false; };
  expect_failure(2, options);
  options.morph.progress = [](const spherical_param::Progress&) -> bool {
    throw std::logic_error("mine");
  };
  EXPECT_THROW(pcl::morphSphericalParam(first, second, 2, output, options), std::logic_error);
  EXPECT_TRUE(output.empty());
  second.setInputCloud(Cloud::Ptr());
  expect_failure(2);
  second.setInputCloud(second_cloud);
  first.setInputCloud(Cloud::Ptr(new Cloud));
  expect_failure(2);
}

}  // namespace
