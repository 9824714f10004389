#include "exact_predicates.h"

#include "indexed.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Exponent of the largest power of two of which all coordinates are multiples.
template <typename... Coordinates>
int commonUnit(const Coordinates&... coordinates) {
  // The exponent of the last digit of x.
  const auto of_number = [](double x) {
    return x == 0.0 ? std::numeric_limits<double>::max_exponent
                    : std::max(std::ilogb(x) - 52, -1074);
  };
  return std::min({coordinates.unaryExpr(of_number).minCoeff()...});
}

/// An integer of any size: digits to the base 2^27, lowest first. Each digit has its own sign, so
/// that differences of short numbers are short.
class Integer {
public:
  Integer() = default;  // 0
  /// x / 2^unit. \param x a multiple of 2^unit.
  Integer(double x, int unit) {
    if (x == 0.0)
      return;
    int exponent = 0;
    double rest = std::frexp(x, &exponent);
    int bits = exponent - unit;  // of the number, at least 1
    digits_.resize(static_cast<std::size_t>((bits + kBits - 1) / kBits), 0);
    for (Index i = digits_.count() - 1; rest != 0.0; --i) {
      const int lower_bits = kBits * i;
      rest = std::ldexp(rest, bits - lower_bits);
      digits_[i] = static_cast<std::int64_t>(rest);
      rest -= static_cast<double>(digits_[i]);
      bits = lower_bits;
    }
  }

  Integer operator+(const Integer& other) const { return plus(1, other); }
  Integer operator-(const Integer& other) const { return plus(-1, other); }
  Integer operator*(const Integer& other) const {
    // Sums stay below 2^63: the shorter factor has fewer than 2^9 digits.
    Integer result;
    result.digits_.resize(digits_.size() + other.digits_.size(), 0);
    for (Index i = 0; i < digits_.count(); ++i)
      for (Index k = 0; digits_[i] != 0 && k < other.digits_.count(); ++k)
        result.digits_[i + k] += digits_[i] * other.digits_[k];
    result.carry();
    return result;
  }
  /// The sign of the last digit: all others together are less than its unit.
  int sign() const { return digits_.empty() ? 0 : digits_.back() < 0 ? -1 : 1; }

private:
  static constexpr int kBits = 27;

  Integer plus(std::int64_t factor, const Integer& other) const {
    Integer sum = *this;
    sum.digits_.resize(std::max(digits_.size(), other.digits_.size()), 0);
    for (Index i = 0; i < other.digits_.count(); ++i)
      sum.digits_[i] += factor * other.digits_[i];
    sum.carry();
    return sum;
  }

  void carry() {
    constexpr std::int64_t base = std::int64_t{1} << kBits;
    std::int64_t over = 0;
    for (std::int64_t& digit : digits_) {
      const std::int64_t sum = digit + over;
      over = sum / base;
      digit = sum % base;
    }
    for (; over != 0; over /= base)
      digits_.push_back(over % base);
    while (!digits_.empty() && digits_.back() == 0)
      digits_.pop_back();
  }

  Indexed<std::int64_t> digits_;  ///< in (-2^27, 2^27), the last is not 0
};

using Vector2 = std::array<Integer, 2>;
using Vector3 = std::array<Integer, 3>;

/// a - b [2^unit]
Vector2 difference(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int unit) {
  return {Integer(a.x(), unit) - Integer(b.x(), unit), Integer(a.y(), unit) - Integer(b.y(), unit)};
}
Vector3 difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int unit) {
  auto [x, y] = difference(Eigen::Vector2d(a.head<2>()), Eigen::Vector2d(b.head<2>()), unit);
  return {std::move(x), std::move(y), Integer(a.z(), unit) - Integer(b.z(), unit)};
}

/// a_x b_y - b_x a_y
template <typename Vector>
Integer minor(const Vector& a, const Vector& b) {
  return a[0] * b[1] - b[0] * a[1];
}

Integer determinant(const Vector3& a, const Vector3& b, const Vector3& c) {
  return a[2] * minor(b, c) + b[2] * minor(c, a) + c[2] * minor(a, b);
}

bool areCollinear(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto flat = [&](const Eigen::Vector3d& p) {
      return Eigen::Vector2d(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    };
    if (orientation2d(flat(a), flat(b), flat(c)) != 0)
      return false;
  }
  return true;
}

}  // namespace

int volumeSign(const Positions& points, const Triangles& triangles) {
  const Eigen::Index count = triangles.cols();
  if (count == 0)
    return 0;
  const auto corner = [&](Eigen::Index t, int k) -> Eigen::Vector3d {
    return points.col(triangles(k, t));
  };
  // Relative to a point of the mesh: far from the origin, digits would be lost.
  const Eigen::Vector3d origin = corner(0, 0);
  double sum = 0.0;
  double lost = 0.0;  // by the roundings of the sum (A. Neumaier, 1974)
  double magnitude = 0.0;
  double largest = 1.0;
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Vector3d a = corner(t, 0) - origin;
    const Eigen::Vector3d b = corner(t, 1) - origin;
    const Eigen::Vector3d c = corner(t, 2) - origin;
    const double term = a.dot(b.cross(c));
    const double next = sum + term;
    lost += std::abs(sum) >= std::abs(term) ? (sum - next) + term : (term - next) + sum;
    sum = next;
    largest = std::max(largest, a.cwiseAbs().maxCoeff());
    magnitude += a.lpNorm<1>() * b.lpNorm<1>() * c.lpNorm<1>();
  }
  sum += lost;
  // Each term has some 8 roundings, `lost` one for each term, and `magnitude` as many as the sum.
  // A product that underflows loses less than the smallest number.
  const auto terms = static_cast<double>(count);
  const double bound = (16.0 + terms * terms * kUnitRoundoff) * 2.0 * kUnitRoundoff * magnitude +
                       16.0 * terms * std::numeric_limits<double>::denorm_min() * largest;
  if (std::abs(sum) > bound && magnitude < 1e200)
    return sum < 0.0 ? -1 : 1;
  Integer exact;
  const int unit = commonUnit(points);
  const auto wide = [&](Eigen::Index t, int k) { return difference(corner(t, k), origin, unit); };
  for (Eigen::Index t = 0; t < count; ++t)
    exact = exact + determinant(wide(t, 0), wide(t, 1), wide(t, 2));
  return exact.sign();
}

bool areCoplanar(const Positions& points) {
  const Eigen::Index n = points.cols();
  if (n < 4)
    return true;
  if (!points.allFinite())
    throw InvalidInput("areCoplanar: a coordinate is not finite; remove such points first");
  // The first points that span a line and a plane, if any do.
  const Eigen::Vector3d a = points.col(0);
  Eigen::Index i = 1;
  while (i < n && points.col(i) == a)
    ++i;
  const Eigen::Vector3d b = points.col(i % n);
  while (i < n && areCollinear(a, b, points.col(i)))
    ++i;
  const Eigen::Vector3d c = points.col(i % n);
  for (; i < n; ++i)
    if (orientation3d(a, b, c, points.col(i)) != 0)
      return false;
  return true;
}

int exactOrientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
  const int unit = commonUnit(a, b, c);
  return minor(difference(a, c, unit), difference(b, c, unit)).sign();
}

int exactInCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d) {
  const int unit = commonUnit(a, b, c, d);
  const auto lifted = [&](const Eigen::Vector2d& p) {  // to a paraboloid
    auto [x, y] = difference(p, d, unit);
    Integer z = x * x + y * y;
    return Vector3{std::move(x), std::move(y), std::move(z)};
  };
  return determinant(lifted(a), lifted(b), lifted(c)).sign();
}

int exactOrientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d) {
  for (int k = 0; k < 3; ++k)
    if (b[k] == a[k] && c[k] == a[k] && d[k] == a[k])
      return 0;
  const int unit = commonUnit(a, b, c, d);
  return determinant(difference(b, a, unit), difference(c, a, unit), difference(d, a, unit)).sign();
}

}  // namespace spherical_param::internal
