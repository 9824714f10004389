#pragma once

#include "corner_table.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/texture_atlas.h"
#include "spherical_param/types.h"

#include <cmath>
#include <sstream>
#include <string>
#include <type_traits>

namespace spherical_param::internal {

/// Throws InvalidInput for a value outside an enumeration whose values count from 0.
///
/// \param what the public function and its option, for the message.
template <typename Enum>
void checkEnum(const std::string& what, Enum value, Enum last) {
  const auto number = static_cast<long long>(value);
  if (number < 0 || number > static_cast<long long>(last))
    throw InvalidInput(what + " = " + std::to_string(number) +
                       " is not a value of its type; use one of its enumerators");
}

/// Throws InvalidInput for a number out of range, also for one that is not a number.
///
/// \param what the public function and its option, for the message.
template <typename Number>
void checkRange(const std::string& what, Number value, std::common_type_t<Number> lowest,
                std::common_type_t<Number> highest) {
  if (value >= lowest && value <= highest)
    return;
  std::ostringstream message;
  message << what << " = " << value << " is out of range; use " << lowest << " to " << highest;
  throw InvalidInput(message.str());
}

/// Throws InvalidInput for the first column that is zero or not finite.
template <typename Columns>
void checkDirections(const char* function, const Columns& directions) {
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    if (!directions.col(i).allFinite() || directions.col(i).isZero(0.0))
      throw InvalidInput(std::string(function) + ": direction " + std::to_string(i) +
                         " is zero or not finite; any other will do");
}

/// Throws InvalidInput for the first column that is not of unit length.
///
/// \param tolerance of the squared length.
inline void checkUnitVectors(const char* function, const Positions& sphere, double tolerance) {
  for (Eigen::Index v = 0; v < sphere.cols(); ++v)
    if (!(std::abs(sphere.col(v).squaredNorm() - 1.0) <= tolerance))
      throw InvalidInput(std::string(function) + ": vertex " + std::to_string(v) + " has length " +
                         std::to_string(sphere.col(v).norm()) + " on the sphere; normalise it");
}

/// Throws InvalidInput for an atlas that makeTextureAtlas() cannot have made.
inline void checkAtlas(const char* function, const TextureAtlas& atlas) {
  checkEnum(std::string(function) + ": chart", atlas.chart, SphereChart::CubeMap);
  checkTriangles(function, atlas.triangles, static_cast<Eigen::Index>(atlas.vertices.size()));
  checkTriangles(function, atlas.coordinate_triangles, atlas.coordinates.cols());
  if (atlas.triangles.cols() != atlas.coordinate_triangles.cols() ||
      !(atlas.coordinates.array() >= 0.0 && atlas.coordinates.array() <= 1.0).all())
    throw InvalidInput(std::string(function) +
                       ": the atlas has no place in [0, 1] for each corner of its triangles; use "
                       "one that makeTextureAtlas() made");
}

}  // namespace spherical_param::internal
