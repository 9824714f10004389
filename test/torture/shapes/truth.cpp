#include "truth.h"

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <regex>

namespace torture {
namespace {

using spherical_param::Index;
using spherical_param::Positions;
using Integer = boost::multiprecision::cpp_int;
using Vector = std::array<Integer, 3>;

constexpr double kLargest = 1e100;

/// Exponent e such that all coordinates are multiples of 2^e.
int commonExponent(const Positions& points) {
  int least = std::numeric_limits<int>::max();
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    const double x = points.data()[i];
    if (x == 0.0)
      continue;
    int exponent = 0;
    std::frexp(x, &exponent);
    least = std::min(least, exponent - 53);
  }
  return least;
}

Integer exactly(double x, int exponent) {
  if (x == 0.0)
    return 0;
  int own = 0;
  const double mantissa = std::ldexp(std::frexp(x, &own), 53);
  Integer result = static_cast<std::int64_t>(mantissa);
  // A negative number is not shifted, but multiplied.
  result *= Integer(1) << static_cast<unsigned>(own - 53 - exponent);
  return result;
}

Vector difference(const Positions& points, Eigen::Index a, Eigen::Index b, int exponent) {
  Vector result;
  for (std::size_t axis = 0; axis < 3; ++axis)
    result[axis] = exactly(points(static_cast<Eigen::Index>(axis), a), exponent) -
                   exactly(points(static_cast<Eigen::Index>(axis), b), exponent);
  return result;
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool isZero(const Vector& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

}  // namespace

Truth::Truth(const Positions& points) : points_(points) {
  for (Eigen::Index i = 0; i < points.cols() && !first_bad_; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(points(axis, i)) <= kLargest))
        first_bad_ = i;
  if (first_bad_)
    return;
  std::map<std::array<std::uint64_t, 3>, Index> first;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    std::array<std::uint64_t, 3> bits{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = points(static_cast<Eigen::Index>(axis), i);
      std::memcpy(&bits[axis], &x, sizeof x);
      if (bits[axis] == std::uint64_t{1} << 63U)
        bits[axis] = 0;
    }
    first_equal_.push_back(first.emplace(bits, static_cast<Index>(i)).first->second);
  }
  distinct_ = first.size();
}

bool Truth::spansSpace() const {
  if (distinct_ < 4)
    return false;
  const int exponent = commonExponent(points_);
  const Eigen::Index n = points_.cols();
  Eigen::Index i = 0;
  Vector along{};
  Vector normal{};
  for (; i < n && isZero(along); ++i)
    along = difference(points_, i, 0, exponent);
  for (; i < n && isZero(normal); ++i)
    normal = cross(along, difference(points_, i, 0, exponent));
  for (; i < n; ++i) {
    const Vector d = difference(points_, i, 0, exponent);
    if (normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2] != 0)
      return true;
  }
  return false;
}

std::string Truth::faultOf(const std::string& reason) const {
  std::smatch match;
  if (std::regex_search(reason, match, std::regex("point (\\d+) is not finite"))) {
    const auto point = static_cast<Eigen::Index>(std::stoll(match[1]));
    return point < points_.cols() && !points_.col(point).allFinite() ? "" : "it is finite";
  }
  if (reason.find("a coordinate is beyond 1e100") != std::string::npos)
    return first_bad_ && (points_.array().abs() > kLargest).any() ? "" : "none is";
  if (first_bad_)
    return "there are points that are not finite, or too large";
  if (std::regex_search(
          reason, match,
          std::regex("at least 4 distinct finite points are needed, but there are (\\d+)")))
    return distinct_ < 4 && std::stoull(match[1]) == distinct_
               ? ""
               : "there are " + std::to_string(distinct_);
  if (reason.find("all points lie in one plane") != std::string::npos)
    return spansSpace() ? "they do not" : "";
  if (reason.find("the input cloud is empty") != std::string::npos)
    return points_.cols() == 0 ? "" : "it is not";
  return "the reason is not known";
}

}  // namespace torture
