// Parts of a cloud, meshed by SphericalParamReconstruction.

#include "reconstructions.h"

#include <pcl/search/kdtree.h>

namespace {

using namespace test;
using spherical_param::PartsMode;

/// 200 points of one ellipsoid and 300 of another beside it, in turn as long as both last.
Cloud::Ptr makeTwo() {
  const Cloud::Ptr small = makeEllipsoid(200);
  const Cloud::Ptr large = makeEllipsoid(300);
  Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < 300; ++i) {
    if (i < 200)
      cloud->push_back((*small)[i]);
    cloud->push_back((*large)[i]);
    cloud->back().x += 5.0F;
  }
  return cloud;
}

Cloud::Ptr beside(const Cloud::Ptr& cloud) {
  for (PointXYZ& point : *cloud)
    point.x += 5.0F;
  return cloud;
}

TEST(PartsOfCloud, AreEachMeshedAsIfTheyWereAlone) {
  for (const bool has_search : {false, true}) {
    Reconstruction reconstruction;
    if (has_search)
      reconstruction.setSearchMethod(
          pcl::search::KdTree<PointXYZ>::Ptr(new pcl::search::KdTree<PointXYZ>));
    reconstruction.setInputCloud(makeTwo());
    reconstruction.setParts(PartsMode::Each);
    EXPECT_EQ(reconstruction.getParts(), PartsMode::Each);
    const Polygons polygons = meshed(reconstruction);
    ASSERT_EQ(reconstruction.getPartCount(), 2U);
    EXPECT_EQ(polygons.size(), 596U + 396U);
    EXPECT_EQ(reconstruction.getUsedIndices(0).size(), 300U);
    EXPECT_EQ(reconstruction.getUsedIndices(1).size(), 200U);
    EXPECT_EQ(reconstruction.getUsedIndices(1)[1], 2);
    Reconstruction alone;
    alone.setInputCloud(beside(makeEllipsoid(300)));
    const Triangles of_large = trianglesOf(meshed(alone));
    EXPECT_EQ(reconstruction.getResult(0).triangles, of_large);
    EXPECT_EQ(reconstruction.getVertexIndices(0).at(static_cast<std::size_t>(of_large(0, 0))),
              polygons.front().vertices.front());
    EXPECT_EQ(reconstruction.getResult(1).triangles, trianglesOf(meshed(makeEllipsoid(200))));
    EXPECT_TRUE(reconstruction.getDiagnosis(1).looksClosedGenus0());
    const auto sphere = reconstruction.getSphereCoordinates();
    EXPECT_TRUE(sphere->is_dense);
    for (const PointXYZ& point : *sphere)
      EXPECT_NEAR(point.getVector3fMap().norm(), 1.0F, 1e-6F);
  }
}

TEST(PartsOfCloud, LargestLeavesOutTheOthers) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeTwo());
  reconstruction.setParts(PartsMode::Largest);
  EXPECT_EQ(meshed(reconstruction).size(), 596U);
  EXPECT_EQ(reconstruction.getPartCount(), 1U);
  EXPECT_EQ(reconstruction.getUsedIndices().size(), 300U);
  EXPECT_FALSE(reconstruction.getSphereCoordinates()->is_dense);
}

TEST(PartsOfCloud, HaveALeastSize) {
  Reconstruction reconstruction;
  reconstruction.setInputCloud(makeTwo());
  reconstruction.setParts(PartsMode::Each);
  reconstruction.setMinPartSize(201);
  EXPECT_EQ(reconstruction.getMinPartSize(), 201);
  EXPECT_EQ(meshed(reconstruction).size(), 596U);
  reconstruction.setMinPartSize(301);
  Polygons polygons;
  reconstruction.reconstruct(polygons);
  EXPECT_TRUE(polygons.empty());
  EXPECT_NE(reconstruction.getErrorMessage().find("no part of the cloud has 301 points"),
            std::string::npos);
  EXPECT_EQ(reconstruction.getPartCount(), 1U);
  EXPECT_EQ(reconstruction.getResult().triangles.cols(), 0);
}

TEST(PartsOfCloud, ThatAreFlatAreLeftOut) {
  Cloud::Ptr cloud = makeEllipsoid(300);
  for (int i = 0; i < 100; ++i)
    cloud->push_back(PointXYZ(5.0F + 0.2F * static_cast<float>(i % 10),
                              0.2F * static_cast<float>(i / 10), 0.0F));
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setParts(PartsMode::Each);
  EXPECT_EQ(meshed(reconstruction).size(), 596U);
  EXPECT_EQ(reconstruction.getPartCount(), 1U);
}

}  // namespace
