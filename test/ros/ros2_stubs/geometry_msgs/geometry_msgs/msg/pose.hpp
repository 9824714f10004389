#pragma once

namespace geometry_msgs::msg {

struct Point {
  double x, y, z;
};

struct Vector3 {
  double x, y, z;
};

struct Quaternion {
  double x, y, z, w;
};

struct Pose {
  Point position;
  Quaternion orientation;
};

}  // namespace geometry_msgs::msg
