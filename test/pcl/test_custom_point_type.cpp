// Custom point types are compiled from the implementation headers, and PCL wants to know that
// before the first of them is included.
#define PCL_NO_PRECOMPILE

#include <pcl/pcl_macros.h>
#include <pcl/register_point_struct.h>
#include <pcl/search/octree.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include "clouds.h"

#include <set>
#include <type_traits>

namespace custom {

// PCL's macro makes anonymous structs.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
/// As PCL's tutorials write it.
struct EIGEN_ALIGN16 ScannerPoint {
  PCL_ADD_POINT4D;
  float reflectance;
  std::uint16_t ring;
  double time;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};
#pragma GCC diagnostic pop

/// Coordinates that are neither the first floats of the struct nor of PCL's alignment.
struct BarePoint {
  float weight;
  float x;
  float y;
  float z;
};

}  // namespace custom

POINT_CLOUD_REGISTER_POINT_STRUCT(custom::ScannerPoint,
                                  (float, x, x)(float, y, y)(float, z, z)(
                                      float, reflectance, reflectance)(std::uint16_t, ring,
                                                                       ring)(double, time, time))
POINT_CLOUD_REGISTER_POINT_STRUCT(custom::BarePoint,
                                  (float, weight, weight)(float, x, x)(float, y, y)(float, z, z))

namespace {

using custom::BarePoint;
using custom::ScannerPoint;

template <typename PointT>
test::Polygons meshed(const typename pcl::PointCloud<PointT>::Ptr& cloud, pcl::PolygonMesh& mesh,
                      const typename pcl::search::Search<PointT>::Ptr& search = {}) {
  pcl::SphericalParamReconstruction<PointT> reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setSearchMethod(search);
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  return mesh.polygons;
}

template <typename PointT>
class CustomPointType : public testing::Test {};
using CustomPointTypes = testing::Types<ScannerPoint, BarePoint>;
TYPED_TEST_SUITE(CustomPointType, CustomPointTypes);

TYPED_TEST(CustomPointType, HasTheMeshOfAStandardOneAndItsOwnFields) {
  const auto cloud = test::makeEllipsoid<TypeParam>(400);
  // Values that would decide the neighbours if they were taken for coordinates.
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if constexpr (std::is_same_v<TypeParam, BarePoint>)
      (*cloud)[i].weight = 1000.0F * static_cast<float>((i * 7919) % 400);
    else
      (*cloud)[i].reflectance = static_cast<float>(i);
  }
  pcl::PolygonMesh mesh;
  const auto triangles = test::trianglesOf(meshed<TypeParam>(cloud, mesh));
  EXPECT_TRUE(test::isSphere(mesh.polygons, 400));
  std::set<std::string> names;
  for (const pcl::PCLPointField& field : mesh.cloud.fields)
    names.insert(field.name);
  if constexpr (std::is_same_v<TypeParam, BarePoint>)
    EXPECT_EQ(names, (std::set<std::string>{"weight", "x", "y", "z"}));
  else
    EXPECT_EQ(names, (std::set<std::string>{"x", "y", "z", "reflectance", "ring", "time"}));
  EXPECT_EQ(test::trianglesOf(meshed<pcl::PointXYZ>(test::makeEllipsoid(400), mesh)), triangles);
}

TEST(ScannerPointSearch, OctreeOfTheUserWorks) {
  pcl::PolygonMesh mesh;
  const pcl::search::Octree<ScannerPoint>::Ptr octree(new pcl::search::Octree<ScannerPoint>(0.1));
  meshed<ScannerPoint>(test::makeEllipsoid<ScannerPoint>(400), mesh, octree);
  EXPECT_TRUE(test::isSphere(mesh.polygons, 400));
}

}  // namespace
