// Parts of a cloud and outliers, in SphericalParamReconstruction.

#include "reconstructions.h"

#include <pcl/search/kdtree.h>

#include <string>

namespace {

using namespace test;
using spherical_param::PartsMode;

Cloud::Ptr beside(const Cloud::Ptr& cloud) {
  for (PointXYZ& point : *cloud)
    point.x += 5.0F;
  return cloud;
}

TEST(PartsOfCloud, AreEachMeshedAsIfTheyWereAlone) {
  const Cloud::Ptr small = makeEllipsoid(200);
  const Cloud::Ptr large = beside(makeEllipsoid(300));
  const Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < 300; ++i) {  // in turn as long as both last
    if (i < 200)
      cloud->push_back((*small)[i]);
    cloud->push_back((*large)[i]);
  }
  for (const bool has_search : {false, true}) {
    Reconstruction reconstruction;
    if (has_search)
      reconstruction.setSearchMethod(
          pcl::search::KdTree<PointXYZ>::Ptr(new pcl::search::KdTree<PointXYZ>));
    reconstruction.setInputCloud(cloud);
    reconstruction.setParts(PartsMode::Each);
    const Polygons polygons = meshed(reconstruction);
    ASSERT_EQ(reconstruction.getPartCount(), 2U);
    EXPECT_EQ(polygons.size(), 596U + 396U);
    EXPECT_EQ(reconstruction.getUsedIndices(0).size(), 300U);
    EXPECT_EQ(reconstruction.getUsedIndices(1).size(), 200U);
    EXPECT_EQ(reconstruction.getUsedIndices(1)[1], 2);
    const Triangles of_large = trianglesOf(meshed(large));
    EXPECT_EQ(reconstruction.getResult().surfaces[0].triangles, of_large);
    EXPECT_EQ(reconstruction.getVertexIndices(0).at(static_cast<std::size_t>(of_large(0, 0))),
              polygons.front().vertices.front());
    EXPECT_EQ(reconstruction.getResult().surfaces[1].triangles, trianglesOf(meshed(small)));
    EXPECT_TRUE(reconstruction.getDiagnosis(1).looksClosedGenus0());
    const auto sphere = reconstruction.getSphereCoordinates();
    EXPECT_TRUE(sphere->is_dense);
    for (const PointXYZ& point : *sphere)
      EXPECT_NEAR(point.getVector3fMap().norm(), 1.0F, 1e-6F);
  }
}

TEST(PartsOfCloud, WithHandlesHaveNoPlaceOnTheSphere) {
  const Cloud::Ptr cloud = makeTorus(24);
  const std::size_t of_torus = cloud->size();
  *cloud += *beside(makeEllipsoid(300));
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setParts(PartsMode::Each);
  meshed(reconstruction);
  ASSERT_EQ(reconstruction.getPartCount(), 2U);
  const auto sphere = reconstruction.getSphereCoordinates();
  ASSERT_EQ(sphere->size(), cloud->size());
  EXPECT_FALSE(sphere->is_dense);
  for (std::size_t i = 0; i < sphere->size(); ++i)
    EXPECT_EQ((*sphere)[i].getVector3fMap().array().isNaN().all(), i < of_torus) << i;
}

TEST(PartsOfCloud, ThatAreFlatAreLeftOutWithAWarning) {
  const Cloud::Ptr cloud = makeEllipsoid(300);
  for (int i = 0; i < 100; ++i)
    cloud->push_back(PointXYZ(5.0F + 0.2F * static_cast<float>(i % 10),
                              0.2F * static_cast<float>(i / 10), 0.0F));
  Reconstruction reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setSurface(spherical_param::SurfaceMode::Closed);
  testing::internal::CaptureStderr();
  EXPECT_EQ(meshed(reconstruction).size(), 596U);
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_NE(warning.find("1 part (100 points) cannot be meshed"), std::string::npos);
  EXPECT_EQ(reconstruction.getPartCount(), 1U);
  EXPECT_EQ(reconstruction.getResult().left_out.other_parts.size(), 100U);
}

}  // namespace
