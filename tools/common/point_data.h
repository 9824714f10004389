#pragma once

#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {

using Point = std::array<float, 3>;
using Color = std::array<std::uint8_t, 4>;  ///< red, green, blue, alpha in 0 ... 255

inline Point toPoint(const std::array<double, 3>& values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

/// 3 x n, in single precision.
inline std::vector<Point> toPoints(const Positions& positions) {
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(positions.cols()));
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    const Eigen::Vector3f point = positions.col(i).cast<float>();
    points.push_back({point.x(), point.y(), point.z()});
  }
  return points;
}

/// Points and what belongs to each of them.
struct PointData {
  std::vector<Point> points;   ///< coordinates [unit of the file], finite or not
  std::vector<Point> normals;  ///< one per point, or none at all
  std::vector<Color> colors;   ///< one per point, or none at all
  bool has_alpha = false;      ///< the alpha of the colours comes from a file; else it is 255
  /// Largest change of a coordinate that was stored with more digits than single precision has
  /// [unit of the file].
  double rounding = 0.0;

  /// Adds a point in single precision, which is PCL's, and takes note of what that changes.
  void addPoint(const std::array<double, 3>& values) {
    const Point point = toPoint(values);
    for (std::size_t d = 0; d < 3; ++d) {
      if (std::isfinite(point[d])) {
        rounding = std::max(rounding, std::abs(values[d] - static_cast<double>(point[d])));
      }
    }
    points.push_back(point);
  }
};

/// Triangles over points; no triangles: a plain cloud.
struct TriangleMesh {
  PointData vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise from outside
};

}  // namespace spherical_param::tools
