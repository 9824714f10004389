// Custom point types are compiled from the implementation headers, and PCL wants to know that
// before the first of them is included.
#define PCL_NO_PRECOMPILE

#include <pcl/conversions.h>
#include <pcl/pcl_macros.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/register_point_struct.h>
#include <pcl/search/octree.h>
#include <pcl/surface/spherical_param_reconstruction.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;
    PointT point{};
    point.x = static_cast<float>(1.5 * radius * std::cos(angle));
    point.y = static_cast<float>(radius * std::sin(angle));
    point.z = static_cast<float>(0.8 * z);
    cloud->push_back(point);
  }
  return cloud;
}

/// V - E + F, with the numbers counted in the polygons; 0 if an edge is not there once each way.
long long eulerCharacteristic(const std::vector<pcl::Vertices>& polygons) {
  std::set<pcl::index_t> vertices;
  std::map<std::pair<pcl::index_t, pcl::index_t>, int> edges;
  for (const pcl::Vertices& polygon : polygons)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      vertices.insert(polygon.vertices[corner]);
      ++edges[{polygon.vertices[corner], polygon.vertices[(corner + 1) % 3]}];
    }
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) == 0)
      return 0;
  return static_cast<long long>(vertices.size()) - static_cast<long long>(edges.size() / 2) +
         static_cast<long long>(polygons.size());
}

template <typename PointT>
class CustomPointType : public testing::Test {};
using CustomPointTypes = testing::Types<ScannerPoint, BarePoint>;
struct CustomPointTypeName {
  template <typename PointT>
  static std::string GetName(int /*index*/) {
    return std::is_same_v<PointT, BarePoint> ? "BarePoint" : "ScannerPoint";
  }
};
TYPED_TEST_SUITE(CustomPointType, CustomPointTypes, CustomPointTypeName);

TYPED_TEST(CustomPointType, EveryPointIsAVertexOfAClosedGenus0Mesh) {
  const auto cloud = makeEllipsoid<TypeParam>(400);
  pcl::SphericalParamReconstruction<TypeParam> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  EXPECT_EQ(mesh.polygons.size(), 2 * cloud->size() - 4);
  EXPECT_EQ(eulerCharacteristic(mesh.polygons), 2);
}

TYPED_TEST(CustomPointType, MeshDoesNotDependOnThePointType) {
  const auto cloud = makeEllipsoid<TypeParam>(400);
  // Values that would decide the neighbours if they were taken for coordinates.
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if constexpr (std::is_same_v<TypeParam, BarePoint>)
      (*cloud)[i].weight = 1000.0F * static_cast<float>((i * 7919) % 400);
    else
      (*cloud)[i].reflectance = static_cast<float>(i);
  }
  pcl::SphericalParamReconstruction<TypeParam> reconstruction;
  reconstruction.setInputCloud(cloud);
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(polygons);

  pcl::SphericalParamReconstruction<pcl::PointXYZ> standard;
  standard.setInputCloud(makeEllipsoid<pcl::PointXYZ>(400));
  std::vector<pcl::Vertices> expected;
  standard.reconstruct(expected);

  ASSERT_FALSE(expected.empty());
  ASSERT_EQ(polygons.size(), expected.size());
  for (std::size_t t = 0; t < polygons.size(); ++t)
    EXPECT_EQ(polygons[t].vertices, expected[t].vertices);
}

TYPED_TEST(CustomPointType, OwnFieldsAreInTheOutput) {
  const auto cloud = makeEllipsoid<TypeParam>(50);
  pcl::SphericalParamReconstruction<TypeParam> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  std::set<std::string> names;
  for (const pcl::PCLPointField& field : mesh.cloud.fields)
    names.insert(field.name);
  if constexpr (std::is_same_v<TypeParam, BarePoint>)
    EXPECT_EQ(names, (std::set<std::string>{"weight", "x", "y", "z"}));
  else
    EXPECT_EQ(names, (std::set<std::string>{"x", "y", "z", "reflectance", "ring", "time"}));
}

TEST(ScannerPointSearch, OctreeOfTheUserWorks) {
  const auto cloud = makeEllipsoid<ScannerPoint>(400);
  pcl::SphericalParamReconstruction<ScannerPoint> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::search::Octree<ScannerPoint>::Ptr octree(new pcl::search::Octree<ScannerPoint>(0.1));
  reconstruction.setSearchMethod(octree);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getErrorMessage(), "");
  EXPECT_EQ(eulerCharacteristic(mesh.polygons), 2);
}

}  // namespace
