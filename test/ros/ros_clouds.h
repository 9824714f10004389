#pragma once

#include "helpers.h"

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>

#include <cstring>

/// Clouds as ROS delivers them.
namespace spherical_param_ros::test {

inline pcl::PCLPointField field(const std::string& name, std::uint32_t offset,
                                std::uint8_t datatype = pcl::PCLPointField::FLOAT32) {
  pcl::PCLPointField result;
  result.name = name;
  result.offset = offset;
  result.datatype = datatype;
  result.count = 1;
  return result;
}

template <typename Value>
void put(pcl::PCLPointCloud2& cloud, std::size_t point, std::size_t offset, const Value& value) {
  std::memcpy(cloud.data.data() + point * cloud.point_step + offset, &value, sizeof(value));
}

inline void setPoint(pcl::PCLPointCloud2& cloud, std::size_t i, double x, double y, double z) {
  put(cloud, i, 0, static_cast<float>(x));
  put(cloud, i, 4, static_cast<float>(y));
  put(cloud, i, 8, static_cast<float>(z));
}

/// n points on an ellipsoid (golden-angle spiral), with their number as intensity, and a colour.
inline pcl::PCLPointCloud2 ellipsoid(std::uint32_t n) {
  pcl::PCLPointCloud2 cloud;
  cloud.header.frame_id = "scanner";
  cloud.header.stamp = 1234567;
  cloud.fields = {field("x", 0), field("y", 4), field("z", 8), field("intensity", 12),
                  field("rgb", 16)};
  cloud.point_step = 20;
  cloud.width = n;
  cloud.height = 1;
  cloud.row_step = n * cloud.point_step;
  cloud.data.resize(cloud.row_step);
  const spherical_param::Positions points =
      Eigen::Vector3d(1.0, 0.8, 0.5).asDiagonal() *
      spherical_param::test::spiralSphere(static_cast<int>(n));
  for (std::uint32_t i = 0; i < n; ++i) {
    setPoint(cloud, i, points(0, i), points(1, i), points(2, i));
    put(cloud, i, 12, static_cast<float>(i));
    put(cloud, i, 16, std::uint32_t{99000000} * (i + 1));
  }
  return cloud;
}

}  // namespace spherical_param_ros::test
