#pragma once

#include "std_msgs/msg/header.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sensor_msgs::msg {

struct PointField {
  std::string name;
  std::uint32_t offset;
  std::uint8_t datatype;
  std::uint32_t count;
};

struct PointCloud2 {
  using ConstSharedPtr = std::shared_ptr<const PointCloud2>;

  std_msgs::msg::Header header;
  std::uint32_t height;
  std::uint32_t width;
  std::vector<PointField> fields;
  bool is_bigendian;
  std::uint32_t point_step;
  std::uint32_t row_step;
  std::vector<std::uint8_t> data;
  bool is_dense;
};

}  // namespace sensor_msgs::msg
