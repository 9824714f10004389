#pragma once

#include "handle_shapes.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

/// What the tests of the PCL classes share.
namespace test {

using spherical_param::Positions;
using Polygons = std::vector<pcl::Vertices>;

/// Half the axes of makeEllipsoid().
inline const Eigen::Vector3d kAxes(1.5, 1.1, 0.8);

/// Colours that change slowly.
inline std::array<double, 3> colorAt(const Eigen::Vector3f& point) {
  const Eigen::Vector3d color = 80.0 * point.cast<double>();
  return {127.0 + color.x(), 127.0 + color.y(), 127.0 + color.z()};
}

/// A cloud of points, with colours if they have some.
template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeCloud(const Positions& points) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (const auto p : points.colwise()) {
    PointT point{};
    point.x = static_cast<float>(p.x());
    point.y = static_cast<float>(p.y());
    point.z = static_cast<float>(p.z());
    if constexpr (pcl::traits::has_color<PointT>::value) {
      const std::array<double, 3> color = colorAt(point.getVector3fMap());
      point.r = static_cast<std::uint8_t>(color[0]);
      point.g = static_cast<std::uint8_t>(color[1]);
      point.b = static_cast<std::uint8_t>(color[2]);
      point.a = 7;
    }
    cloud->push_back(point);
  }
  cloud->header.seq = 12;
  cloud->header.stamp = 42;
  cloud->header.frame_id = "scanner";
  return cloud;
}

/// Points spread evenly over an ellipsoid, in the order of a spiral; the axes differ so that no two
/// distances are the same.
template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count,
                                                    const Eigen::Vector3d& axes = kAxes) {
  return makeCloud<PointT>(axes.asDiagonal() * spherical_param::test::spiralSphere(count));
}

/// A torus around z, with twice as many rings as points in each.
inline pcl::PointCloud<pcl::PointXYZ>::Ptr makeTorus(int around) {
  return makeCloud(spherical_param::test::torusCloud(2 * around, around));
}

inline spherical_param::Triangles trianglesOf(const Polygons& polygons) {
  spherical_param::Triangles triangles(3, static_cast<Eigen::Index>(polygons.size()));
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices.at(corner);
  return triangles;
}

/// Whether the polygons are a closed mesh of this genus over so many points.
inline bool isClosed(const Polygons& polygons, std::size_t points, int genus) {
  return spherical_param::test::isSurfaceOverAll(trianglesOf(polygons), static_cast<int>(points),
                                                 genus);
}
inline bool isSphere(const Polygons& polygons, std::size_t points) {
  return isClosed(polygons, points, 0);
}

template <typename PointT>
pcl::PointCloud<PointT> cloudOf(const pcl::PCLPointCloud2& cloud) {
  pcl::PointCloud<PointT> points;
  pcl::fromPCLPointCloud2(cloud, points);
  return points;
}

/// Silences PCL, since many tests provoke failures.
class Silent : public testing::Test {
protected:
  void SetUp() override { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  void TearDown() override { pcl::console::setVerbosityLevel(pcl::console::L_INFO); }
};

}  // namespace test
