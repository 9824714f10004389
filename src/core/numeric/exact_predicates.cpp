#include "exact_predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

// Theorem and lemma numbers are those of Shewchuk (1997), see the header.

namespace spherical_param::internal {
namespace {

/// Sum of non-overlapping doubles of increasing magnitude, at most N of them.
template <std::size_t N>
struct Expansion {
  std::array<double, N> terms;  ///< the first `size` are set
  std::size_t size = 0;

  void append(double term) {
    if (term != 0.0)
      terms[size++] = term;
  }
  int sign() const {
    // The largest term decides: it exceeds the sum of all others.
    return size == 0 ? 0 : (terms[size - 1] > 0.0) - (terms[size - 1] < 0.0);
  }
};

/// a + b = sum + error (theorem 7).
void twoSum(double a, double b, double& sum, double& error) {
  sum = a + b;
  const double b_virtual = sum - a;
  const double a_virtual = sum - b_virtual;
  error = (a - a_virtual) + (b - b_virtual);
}

/// a + b = sum + error for |a| >= |b| (theorem 6).
void fastTwoSum(double a, double b, double& sum, double& error) {
  sum = a + b;
  error = b - (sum - a);
}

/// a * b = product + error.
void twoProduct(double a, double b, double& product, double& error) {
  product = a * b;
  error = std::fma(a, b, -product);
}

/// The exact difference of two doubles.
Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  double sum = 0.0;
  double error = 0.0;
  twoSum(a, -b, sum, error);
  result.append(error);
  result.append(sum);
  return result;
}

/// a + factor * b for a factor of 1 or -1 (theorem 12, linear expansion sum).
template <std::size_t N, std::size_t M>
Expansion<N + M> sum(const Expansion<N>& a, const Expansion<M>& b, double factor) {
  Expansion<N + M> result;
  std::size_t i = 0;
  std::size_t j = 0;
  const auto next = [&] {  // the smallest of what is left
    if (j == b.size || (i < a.size && std::abs(a.terms[i]) <= std::abs(b.terms[j])))
      return a.terms[i++];
    return factor * b.terms[j++];
  };
  const std::size_t count = a.size + b.size;
  if (count == 0)
    return result;
  double high = next();
  if (count > 1) {
    double low = 0.0;
    fastTwoSum(next(), high, high, low);
    for (std::size_t k = 2; k < count; ++k) {
      double carry = 0.0;
      double rest = 0.0;
      fastTwoSum(next(), low, carry, rest);
      result.append(rest);
      twoSum(high, carry, high, low);
    }
    result.append(low);
  }
  result.append(high);
  return result;
}

/// a * b (theorem 19, scale expansion).
template <std::size_t N>
Expansion<2 * N> scaled(const Expansion<N>& a, double b) {
  Expansion<2 * N> result;
  if (a.size == 0)
    return result;
  double high = 0.0;
  double low = 0.0;
  twoProduct(a.terms[0], b, high, low);
  result.append(low);
  for (std::size_t i = 1; i < a.size; ++i) {
    double product = 0.0;
    double product_low = 0.0;
    double middle = 0.0;
    twoProduct(a.terms[i], b, product, product_low);
    twoSum(high, product_low, middle, low);
    result.append(low);
    fastTwoSum(product, middle, high, low);
    result.append(low);
  }
  result.append(high);
  return result;
}

/// a * b, in a balanced tree of sums over the terms [begin, begin + M) of b.
template <std::size_t M, std::size_t N, std::size_t B>
Expansion<2 * N * M> partialProduct(const Expansion<N>& a, const Expansion<B>& b,
                                    std::size_t begin) {
  Expansion<2 * N * M> result;
  if (begin < b.size) {
    if constexpr (M == 1)
      result = scaled(a, b.terms[begin]);
    else
      result = sum(partialProduct<M / 2>(a, b, begin),
                   partialProduct<M - M / 2>(a, b, begin + M / 2), 1.0);
  }
  return result;
}
template <std::size_t N, std::size_t M>
Expansion<2 * N * M> product(const Expansion<N>& a, const Expansion<M>& b) {
  return partialProduct<M>(a, b, 0);
}

/// x1 * y2 - x2 * y1
Expansion<16> minor(const Expansion<2>& x1, const Expansion<2>& y1, const Expansion<2>& x2,
                    const Expansion<2>& y2) {
  return sum(product(x1, y2), product(x2, y1), -1.0);
}

/// x^2 + y^2
Expansion<16> squaredNorm(const Expansion<2>& x, const Expansion<2>& y) {
  return sum(product(x, x), product(y, y), 1.0);
}

/// An integer of any size, a multiple of the least positive double: digits to the base 2^24, lowest
/// first. Each has its own sign, so that differences of numbers of few digits have few digits.
class WideInteger {
public:
  explicit WideInteger(double x) {
    int exponent = 0;
    const double mantissa = std::frexp(x, &exponent);
    // The bits of x begin at `position` above those of the least double.
    constexpr int digits_of_mantissa = 53;
    constexpr int least_exponent = -1074;
    const int position = std::max(exponent - digits_of_mantissa - least_exponent, 0);
    auto bits = static_cast<std::int64_t>(
        std::ldexp(mantissa, std::min(digits_of_mantissa, exponent - least_exponent)));
    digits_.assign(static_cast<std::size_t>(position / kBits), 0);
    // Shifted digit by digit, so that nothing overflows.
    const std::int64_t factor = std::int64_t{1} << (position % kBits);
    for (; bits != 0; bits /= kBase)
      digits_.push_back(bits % kBase * factor);
    carry();
  }

  WideInteger operator-(const WideInteger& other) const { return plus(other, -1); }
  WideInteger operator+(const WideInteger& other) const { return plus(other, 1); }
  WideInteger operator*(const WideInteger& other) const {
    // Sums stay below 2^63: the shorter factor has fewer than 2^9 digits of 24 bits.
    WideInteger result(0.0);
    result.digits_.assign(digits_.size() + other.digits_.size(), 0);
    for (std::size_t i = 0; i < digits_.size(); ++i)
      for (std::size_t k = 0; digits_[i] != 0 && k < other.digits_.size(); ++k)
        result.digits_[i + k] += digits_[i] * other.digits_[k];
    result.carry();
    return result;
  }
  /// That of the last digit: the others amount to less than its unit.
  int sign() const { return digits_.empty() ? 0 : digits_.back() < 0 ? -1 : 1; }

private:
  static constexpr int kBits = 24;
  static constexpr std::int64_t kBase = std::int64_t{1} << kBits;

  WideInteger plus(const WideInteger& other, std::int64_t factor) const {
    WideInteger result = *this;
    result.digits_.resize(std::max(digits_.size(), other.digits_.size()), 0);
    for (std::size_t i = 0; i < other.digits_.size(); ++i)
      result.digits_[i] += factor * other.digits_[i];
    result.carry();
    return result;
  }

  void carry() {
    std::int64_t over = 0;
    for (std::int64_t& digit : digits_) {
      const std::int64_t sum = digit + over;
      over = sum / kBase;
      digit = sum % kBase;
    }
    for (; over != 0; over /= kBase)
      digits_.push_back(over % kBase);
    while (!digits_.empty() && digits_.back() == 0)
      digits_.pop_back();
  }

  std::vector<std::int64_t> digits_;  ///< in (-2^24, 2^24), the last is not 0
};

/// Whether the terms of all are 0, or of a size at which products of three are exact.
template <typename... Differences>
bool areProductsExact(const Differences&... differences) {
  const auto is_in_range = [](const Expansion<2>& difference) {
    return std::all_of(
        difference.terms.begin(),
        difference.terms.begin() + static_cast<std::ptrdiff_t>(difference.size),
        [](double term) { return std::abs(term) >= 0x1p-300 && std::abs(term) <= 0x1p300; });
  };
  return (is_in_range(differences) && ...);
}

WideInteger wideDifference(double a, double b) {
  return WideInteger(a) - WideInteger(b);
}

int integerOrientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                         const Eigen::Vector2d& c) {
  return (wideDifference(a.x(), c.x()) * wideDifference(b.y(), c.y()) -
          wideDifference(a.y(), c.y()) * wideDifference(b.x(), c.x()))
      .sign();
}

int integerOrientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const auto row = [&](const Eigen::Vector3d& p) {
    return std::array<WideInteger, 3>{wideDifference(p.x(), a.x()), wideDifference(p.y(), a.y()),
                                      wideDifference(p.z(), a.z())};
  };
  const auto u = row(b);
  const auto v = row(c);
  const auto w = row(d);
  return (u[2] * (v[0] * w[1] - w[0] * v[1]) + v[2] * (w[0] * u[1] - u[0] * w[1]) +
          w[2] * (u[0] * v[1] - v[0] * u[1]))
      .sign();
}

}  // namespace

int volumeSign(const Positions& points, const Triangles& triangles) {
  const Eigen::Index count = triangles.cols();
  if (count == 0)
    return 0;
  const auto corner = [&](Eigen::Index t, int k) { return points.col(triangles(k, t)); };
  // About a point of the mesh, so that a far origin costs no digits.
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
    magnitude +=
        a.cwiseAbs().dot(Eigen::Vector3d(std::abs(b.y() * c.z()) + std::abs(b.z() * c.y()),
                                         std::abs(b.z() * c.x()) + std::abs(b.x() * c.z()),
                                         std::abs(b.x() * c.y()) + std::abs(b.y() * c.x())));
  }
  sum += lost;
  // A term has some 8 roundings, what was lost one for each of them, and the magnitude has as many;
  // products that underflow lose less than the least number each.
  const auto terms = static_cast<double>(count);
  const double bound = (16.0 + terms * terms * kUnitRoundoff) * 2.0 * kUnitRoundoff * magnitude +
                       16.0 * terms * std::numeric_limits<double>::denorm_min() * largest;
  if (std::abs(sum) > bound && magnitude < 1e200)
    return sum < 0.0 ? -1 : 1;
  // Around any origin a closed mesh has the same volume; around 0 nothing is subtracted.
  WideInteger exact(0.0);
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto wide = [&](int k) {
      const Eigen::Vector3d p = corner(t, k);
      return std::array<WideInteger, 3>{WideInteger(p.x()), WideInteger(p.y()), WideInteger(p.z())};
    };
    const auto a = wide(0);
    const auto b = wide(1);
    const auto c = wide(2);
    exact = exact + a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return exact.sign();
}

int exactOrientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
  const Expansion<2> ax = difference(a.x(), c.x());
  const Expansion<2> ay = difference(a.y(), c.y());
  const Expansion<2> bx = difference(b.x(), c.x());
  const Expansion<2> by = difference(b.y(), c.y());
  return areProductsExact(ax, ay, bx, by) ? minor(ax, ay, bx, by).sign()
                                          : integerOrientation2d(a, b, c);
}

int exactInCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d) {
  const Expansion<2> ax = difference(a.x(), d.x());
  const Expansion<2> ay = difference(a.y(), d.y());
  const Expansion<2> bx = difference(b.x(), d.x());
  const Expansion<2> by = difference(b.y(), d.y());
  const Expansion<2> cx = difference(c.x(), d.x());
  const Expansion<2> cy = difference(c.y(), d.y());
  return sum(sum(product(minor(bx, by, cx, cy), squaredNorm(ax, ay)),
                 product(minor(cx, cy, ax, ay), squaredNorm(bx, by)), 1.0),
             product(minor(ax, ay, bx, by), squaredNorm(cx, cy)), 1.0)
      .sign();
}

int exactOrientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d) {
  const Expansion<2> ax = difference(b.x(), a.x());
  const Expansion<2> ay = difference(b.y(), a.y());
  const Expansion<2> az = difference(b.z(), a.z());
  const Expansion<2> bx = difference(c.x(), a.x());
  const Expansion<2> by = difference(c.y(), a.y());
  const Expansion<2> bz = difference(c.z(), a.z());
  const Expansion<2> cx = difference(d.x(), a.x());
  const Expansion<2> cy = difference(d.y(), a.y());
  const Expansion<2> cz = difference(d.z(), a.z());
  if (ax.size + bx.size + cx.size == 0 || ay.size + by.size + cy.size == 0 ||
      az.size + bz.size + cz.size == 0)
    return 0;
  if (!areProductsExact(ax, ay, az, bx, by, bz, cx, cy, cz))
    return integerOrientation3d(a, b, c, d);
  return sum(sum(product(minor(bx, by, cx, cy), az), product(minor(cx, cy, ax, ay), bz), 1.0),
             product(minor(ax, ay, bx, by), cz), 1.0)
      .sign();
}

}  // namespace spherical_param::internal
