#pragma once

#include "geometry_msgs/msg/pose.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace shape_msgs::msg {

struct MeshTriangle {
  std::array<std::uint32_t, 3> vertex_indices;
};

struct Mesh {
  std::vector<MeshTriangle> triangles;
  std::vector<geometry_msgs::msg::Point> vertices;
};

}  // namespace shape_msgs::msg
