#pragma once

#include <string>

namespace rcl_interfaces::msg {

struct ParameterDescriptor {
  std::string description;
  bool dynamic_typing;
};

}  // namespace rcl_interfaces::msg
