#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {

using Point = std::array<float, 3>;
using Color = std::array<std::uint8_t, 4>;  ///< red, green, blue, alpha in 0 ... 255

/// Points and what belongs to each of them.
struct PointData {
  std::vector<Point> points;   ///< coordinates [unit of the file], finite or not
  std::vector<Point> normals;  ///< one per point, or none at all
  std::vector<Color> colors;   ///< one per point, or none at all
  bool has_alpha = false;      ///< the alpha of the colours comes from a file; else it is 255
};

/// Triangles over points; no triangles: a plain cloud.
struct TriangleMesh {
  PointData vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise from outside
};

/// The points of the given indices, in that order, with what belongs to them.
template <typename IndexRange>
PointData selectPoints(const PointData& data, const IndexRange& indices) {
  PointData selected;
  selected.has_alpha = data.has_alpha;
  for (const auto index : indices) {
    const auto i = static_cast<std::size_t>(index);
    selected.points.push_back(data.points[i]);
    if (!data.normals.empty()) {
      selected.normals.push_back(data.normals[i]);
    }
    if (!data.colors.empty()) {
      selected.colors.push_back(data.colors[i]);
    }
  }
  return selected;
}

}  // namespace spherical_param::tools
