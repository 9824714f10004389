#include "core/exact_predicates.h"

#include <array>
#include <cmath>
#include <cstddef>

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

}  // namespace

int exactOrientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
  return minor(difference(a.x(), c.x()), difference(a.y(), c.y()), difference(b.x(), c.x()),
               difference(b.y(), c.y()))
      .sign();
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
  return sum(sum(product(minor(bx, by, cx, cy), az), product(minor(cx, cy, ax, ay), bz), 1.0),
             product(minor(ax, ay, bx, by), cz), 1.0)
      .sign();
}

}  // namespace spherical_param::internal
