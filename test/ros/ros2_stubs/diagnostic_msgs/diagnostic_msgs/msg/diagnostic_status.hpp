#pragma once

namespace diagnostic_msgs::msg {

struct DiagnosticStatus {
  static constexpr unsigned char OK = 0;
  static constexpr unsigned char WARN = 1;
};

}  // namespace diagnostic_msgs::msg
