#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The median; the upper one of two. Changes the order of the values.
///
/// \param values not empty.
inline double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace spherical_param::internal
