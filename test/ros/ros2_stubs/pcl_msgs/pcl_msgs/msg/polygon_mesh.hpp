#pragma once

#include "sensor_msgs/msg/point_cloud2.hpp"
#include "std_msgs/msg/header.hpp"

#include <cstdint>
#include <vector>

namespace pcl_msgs::msg {

struct Vertices {
  std::vector<std::uint32_t> vertices;
};

struct PolygonMesh {
  std_msgs::msg::Header header;
  sensor_msgs::msg::PointCloud2 cloud;
  std::vector<Vertices> polygons;
};

}  // namespace pcl_msgs::msg
