#pragma once

namespace spherical_param::internal {

constexpr double kPi = 3.14159265358979323846;

}  // namespace spherical_param::internal
