#pragma once

#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param::tools {

using Point = std::array<double, 3>;        ///< coordinates [unit of the file]
using FloatTriple = std::array<float, 3>;   ///< as files store it
using Normal = FloatTriple;                 ///< of length 1
using Color = std::array<std::uint8_t, 4>;  ///< red, green, blue, alpha in 0 ... 255

inline FloatTriple toFloat(const std::array<double, 3>& values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

inline std::vector<Point> toPoints(const Positions& positions) {
  std::vector<Point> points(static_cast<std::size_t>(positions.cols()));
  for (std::size_t i = 0; i < points.size(); ++i)
    Eigen::Map<Eigen::Vector3d>(points[i].data()) = positions.col(static_cast<Eigen::Index>(i));
  return points;
}

inline std::vector<Normal> toNormals(const Positions& directions) {
  std::vector<Normal> normals;
  normals.reserve(static_cast<std::size_t>(directions.cols()));
  for (const Point& direction : toPoints(directions))
    normals.push_back(toFloat(direction));
  return normals;
}

/// A further number of each point, e.g. its intensity.
struct Scalar {
  std::string name;  ///< without blanks
  std::vector<double> values;
  bool is_double = false;  ///< single precision would change them
};

/// Points and what belongs to each of them.
struct PointData {
  std::vector<Point> points;       ///< finite or not
  std::vector<Normal> normals;     ///< one per point, or none at all
  std::vector<Color> colors;       ///< one per point, or none at all
  std::vector<Scalar> scalars;     ///< each with one number per point
  std::vector<Index> unused;       ///< points that are in no face of the file
  std::optional<Point> viewpoint;  ///< of the sensor, if the file says it
  std::size_t rows = 1;            ///< of an image, of which the points are the pixels; 1: of none
  bool has_null_normals = false;   ///< the normals of the file are all zero, and left out
  bool has_alpha = false;          ///< the alpha of the colours comes from a file; else it is 255
  std::string contents;            ///< what was taken from a file, e.g. "text, columns x y z"

  Eigen::Map<const Eigen::Vector3d> position(std::size_t i) const {
    return Eigen::Map<const Eigen::Vector3d>(points[i].data());
  }
};

inline Positions positionsOf(const PointData& data) {
  return Eigen::Map<const Positions>(data.points.front().data(), 3,
                                     static_cast<Eigen::Index>(data.points.size()));
}

/// Triangles over points; no triangles: a plain cloud.
struct TriangleMesh {
  PointData vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise from outside
};

}  // namespace spherical_param::tools
