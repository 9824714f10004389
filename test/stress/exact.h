#pragma once

#include "spherical_param/types.h"

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

/// What is true of points, in exact arithmetic and without the library.
namespace stress {

using Place = std::tuple<double, double, double>;

inline Place placeOf(const spherical_param::Positions& points, Eigen::Index i) {
  // + 0.0: -0 is 0
  return {points(0, i) + 0.0, points(1, i) + 0.0, points(2, i) + 0.0};
}

inline std::size_t countDistinct(const spherical_param::Positions& points) {
  std::set<Place> places;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    places.insert(placeOf(points, i));
  return places.size();
}

/// Whether finite points lie in one plane: in integers of any size.
inline bool liesInPlane(const spherical_param::Positions& points) {
  using Integer = boost::multiprecision::cpp_int;
  using Vector = std::array<Integer, 3>;
  constexpr int least_exponent = -1074;
  const auto integer = [](double x) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    const int shift = exponent - 53 - least_exponent;
    const Integer value = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    // A negative number is multiplied, not shifted. The bits below the least exponent are 0.
    if (shift >= 0)
      return Integer(value * (Integer(1) << static_cast<unsigned>(shift)));
    return Integer(value / (Integer(1) << static_cast<unsigned>(-shift)));
  };
  std::vector<Vector> vectors;
  for (Eigen::Index i = 1; i < points.cols(); ++i)
    vectors.push_back({integer(points(0, i)) - integer(points(0, 0)),
                       integer(points(1, i)) - integer(points(1, 0)),
                       integer(points(2, i)) - integer(points(2, 0))});
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto is_zero = [](const Vector& a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; };
  const auto first = std::find_if_not(vectors.begin(), vectors.end(), is_zero);
  if (first == vectors.end())
    return true;
  Vector normal{};
  for (const Vector& v : vectors)
    if (is_zero(normal))
      normal = cross(*first, v);
  return std::all_of(vectors.begin(), vectors.end(), [&](const Vector& v) {
    return v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2] == 0;
  });
}

}  // namespace stress
