#pragma once

#include "geometry_msgs/msg/pose.hpp"
#include "std_msgs/msg/color_rgba.hpp"
#include "std_msgs/msg/header.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace visualization_msgs::msg {

struct Marker {
  static constexpr std::int32_t TRIANGLE_LIST = 11;
  static constexpr std::int32_t ADD = 0;

  std_msgs::msg::Header header;
  std::string ns;
  std::int32_t type;
  std::int32_t action;
  geometry_msgs::msg::Pose pose;
  geometry_msgs::msg::Vector3 scale;
  std_msgs::msg::ColorRGBA color;
  std::vector<geometry_msgs::msg::Point> points;
  std::vector<std_msgs::msg::ColorRGBA> colors;
};

}  // namespace visualization_msgs::msg
