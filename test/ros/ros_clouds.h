#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

/// Clouds as middleware brings them.
namespace spherical_param_ros::test {

inline pcl::PCLPointField field(const std::string& name, std::uint32_t offset,
                                std::uint8_t datatype) {
  pcl::PCLPointField result;
  result.name = name;
  result.offset = offset;
  result.datatype = datatype;
  result.count = 1;
  return result;
}

inline void put(pcl::PCLPointCloud2& cloud, std::size_t point, std::size_t offset,
                const void* value, std::size_t size) {
  std::memcpy(cloud.data.data() + point * cloud.point_step + offset, value, size);
}

/// A cloud of n points with x, y, z, the number of the point as intensity, and a colour from it.
inline pcl::PCLPointCloud2 emptyCloud(std::uint32_t n) {
  pcl::PCLPointCloud2 cloud;
  cloud.header.frame_id = "scanner";
  cloud.header.stamp = 1234567;
  cloud.fields = {field("x", 0, pcl::PCLPointField::FLOAT32),
                  field("y", 4, pcl::PCLPointField::FLOAT32),
                  field("z", 8, pcl::PCLPointField::FLOAT32),
                  field("intensity", 12, pcl::PCLPointField::FLOAT32),
                  field("rgb", 16, pcl::PCLPointField::FLOAT32)};
  cloud.point_step = 20;
  cloud.width = n;
  cloud.height = 1;
  cloud.row_step = n * cloud.point_step;
  cloud.data.resize(cloud.row_step);
  return cloud;
}

inline void setPoint(pcl::PCLPointCloud2& cloud, std::uint32_t i, float x, float y, float z) {
  const float point[] = {x, y, z, static_cast<float>(i)};
  const std::uint8_t bgra[] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), 77,
                               0};
  put(cloud, i, 0, point, sizeof(point));
  put(cloud, i, 16, bgra, sizeof(bgra));
}

/// n points on an ellipsoid, evenly (golden-angle spiral).
inline pcl::PCLPointCloud2 ellipsoid(std::uint32_t n) {
  pcl::PCLPointCloud2 cloud = emptyCloud(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    setPoint(cloud, i, static_cast<float>(radius * std::cos(angle)),
             static_cast<float>(0.8 * radius * std::sin(angle)), static_cast<float>(0.5 * z));
  }
  return cloud;
}

}  // namespace spherical_param_ros::test
