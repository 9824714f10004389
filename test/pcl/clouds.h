#pragma once

#include "spherical_param/mesh_topology.h"

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

/// What the tests of the PCL classes share.
namespace test {

using Polygons = std::vector<pcl::Vertices>;

/// Half the axes of makeEllipsoid().
inline const Eigen::Vector3d kAxes(1.5, 1.1, 0.8);

/// Colours that change slowly.
inline std::array<double, 3> colorAt(const Eigen::Vector3f& point) {
  const Eigen::Vector3d color = 80.0 * point.cast<double>();
  return {127.0 + color.x(), 127.0 + color.y(), 127.0 + color.z()};
}

/// Points spread evenly over an ellipsoid, in the order of a spiral; the axes differ so that no two
/// distances are the same.
template <typename PointT = pcl::PointXYZ>
typename pcl::PointCloud<PointT>::Ptr makeEllipsoid(int count,
                                                    const Eigen::Vector3d& axes = kAxes) {
  typename pcl::PointCloud<PointT>::Ptr cloud(new pcl::PointCloud<PointT>);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = i * 2.399963229728653;  // the golden angle
    PointT point{};
    point.x = static_cast<float>(axes.x() * radius * std::cos(angle));
    point.y = static_cast<float>(axes.y() * radius * std::sin(angle));
    point.z = static_cast<float>(axes.z() * z);
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

/// A torus around z, with twice as many rings as points in each.
inline pcl::PointCloud<pcl::PointXYZ>::Ptr makeTorus(int around) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  const double step = 2.0 * std::acos(-1.0) / around;
  for (int ring = 0; ring < 2 * around; ++ring)
    for (int k = 0; k < around; ++k) {
      const double u = step * ring / 2.0;
      const double v = step * (k + ring % 2 / 2.0);
      const double radius = 1.0 + 0.4 * std::cos(v);
      cloud->push_back(pcl::PointXYZ(static_cast<float>(radius * std::cos(u)),
                                     static_cast<float>(radius * std::sin(u)),
                                     static_cast<float>(0.4 * std::sin(v))));
    }
  return cloud;
}

inline spherical_param::Triangles trianglesOf(const Polygons& polygons) {
  spherical_param::Triangles triangles(3, static_cast<Eigen::Index>(polygons.size()));
  for (std::size_t t = 0; t < polygons.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangles(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(t)) =
          polygons[t].vertices.at(corner);
  return triangles;
}

/// Whether the polygons are a closed genus-0 mesh over so many points.
inline bool isSphere(const Polygons& polygons, std::size_t points) {
  const spherical_param::MeshTopology topology =
      spherical_param::checkTopology(trianglesOf(polygons), points);
  return topology.isSphere() && topology.vertices == points;
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
