#pragma once

namespace std_msgs::msg {

struct ColorRGBA {
  float r, g, b, a;
};

}  // namespace std_msgs::msg
