#include "core/space_filling_curve.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Moves the lowest 21 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffffU;
  x = (x | x << 32U) & 0x001f00000000ffffULL;
  x = (x | x << 16U) & 0x001f0000ff0000ffULL;
  x = (x | x << 8U) & 0x100f00f00f00f00fULL;
  x = (x | x << 4U) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2U) & 0x1249249249249249ULL;
  return x;
}

}  // namespace

std::vector<Index> mortonOrder(const Positions& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Index> order(n);
  if (n == 0)
    return order;
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const double extent = (points.rowwise().maxCoeff() - low).maxCoeff();
  constexpr double cells = 2097151.0;  // 2^21 - 1
  const double scale = extent > 0.0 ? cells / extent : 0.0;
  std::vector<std::pair<std::uint64_t, Index>> keys(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d cell = (points.col(static_cast<Eigen::Index>(i)) - low) * scale;
    const auto key = spread(static_cast<std::uint64_t>(cell.x())) |
                     spread(static_cast<std::uint64_t>(cell.y())) << 1U |
                     spread(static_cast<std::uint64_t>(cell.z())) << 2U;
    keys[i] = {key, static_cast<Index>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::transform(keys.begin(), keys.end(), order.begin(),
                 [](const auto& key) { return key.second; });
  return order;
}

}  // namespace spherical_param::internal
