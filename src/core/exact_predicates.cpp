#include "core/exact_predicates.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

// Filtered evaluation with an exact fallback in floating-point expansions, after J. R. Shewchuk:
// "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete &
// Computational Geometry 18, 1997 (theorem and lemma numbers below are his). Valid for
// round-to-nearest and without contraction of a * b + c.

namespace spherical_param::internal {
namespace {

/// Sum of non-overlapping doubles of increasing magnitude, at most N of them.
template <std::size_t N>
struct Expansion {
  std::array<double, N> terms{};
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

/// Adds one double to an expansion that has room for one more term (theorem 10).
template <std::size_t N>
void grow(Expansion<N>& expansion, double value) {
  Expansion<N> result;
  double carry = value;
  for (std::size_t i = 0; i < expansion.size; ++i) {
    double sum = 0.0;
    double error = 0.0;
    twoSum(carry, expansion.terms[i], sum, error);
    result.append(error);
    carry = sum;
  }
  result.append(carry);
  expansion = result;
}

template <std::size_t N, std::size_t M>
void add(Expansion<N>& expansion, const Expansion<M>& other, double factor) {
  for (std::size_t i = 0; i < other.size; ++i)
    grow(expansion, factor * other.terms[i]);
}

template <std::size_t N, std::size_t M>
Expansion<2 * N * M> product(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<2 * N * M> result;
  for (std::size_t i = 0; i < a.size; ++i)
    for (std::size_t j = 0; j < b.size; ++j) {
      double high = 0.0;
      double low = 0.0;
      twoProduct(a.terms[i], b.terms[j], high, low);
      grow(result, low);
      grow(result, high);
    }
  return result;
}

/// x1 * y2 - x2 * y1
Expansion<16> minor(const Expansion<2>& x1, const Expansion<2>& y1, const Expansion<2>& x2,
                    const Expansion<2>& y2) {
  Expansion<16> result;
  add(result, product(x1, y2), 1.0);
  add(result, product(x2, y1), -1.0);
  return result;
}

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;
/// Bounds of the error of the plain evaluation relative to the permanent (Shewchuk, section 4.2
/// and table 2: ccwerrboundA and o3derrboundA).
constexpr double kFilter2d = (3.0 + 16.0 * kUnitRoundoff) * kUnitRoundoff;
constexpr double kFilter3d = (7.0 + 56.0 * kUnitRoundoff) * kUnitRoundoff;

}  // namespace

int orientation2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  const double bound = kFilter2d * (std::abs(left) + std::abs(right));
  if (determinant > bound || -determinant > bound)
    return determinant > 0.0 ? 1 : -1;
  if (bound == 0.0)
    return 0;
  return minor(difference(a.x(), c.x()), difference(a.y(), c.y()), difference(b.x(), c.x()),
               difference(b.y(), c.y()))
      .sign();
}

int orientation3d(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const Eigen::Vector3d& d) {
  const Eigen::Vector3d ad = b - a;
  const Eigen::Vector3d bd = c - a;
  const Eigen::Vector3d cd = d - a;
  const double bc = bd.x() * cd.y();
  const double cb = cd.x() * bd.y();
  const double ca = cd.x() * ad.y();
  const double ac = ad.x() * cd.y();
  const double ab = ad.x() * bd.y();
  const double ba = bd.x() * ad.y();
  const double determinant = ad.z() * (bc - cb) + bd.z() * (ca - ac) + cd.z() * (ab - ba);
  const double permanent = (std::abs(bc) + std::abs(cb)) * std::abs(ad.z()) +
                           (std::abs(ca) + std::abs(ac)) * std::abs(bd.z()) +
                           (std::abs(ab) + std::abs(ba)) * std::abs(cd.z());
  const double bound = kFilter3d * permanent;
  if (determinant > bound || -determinant > bound)
    return determinant > 0.0 ? 1 : -1;
  if (bound == 0.0)
    return 0;

  const Expansion<2> ax = difference(b.x(), a.x());
  const Expansion<2> ay = difference(b.y(), a.y());
  const Expansion<2> az = difference(b.z(), a.z());
  const Expansion<2> bx = difference(c.x(), a.x());
  const Expansion<2> by = difference(c.y(), a.y());
  const Expansion<2> bz = difference(c.z(), a.z());
  const Expansion<2> cx = difference(d.x(), a.x());
  const Expansion<2> cy = difference(d.y(), a.y());
  const Expansion<2> cz = difference(d.z(), a.z());
  Expansion<192> exact;
  add(exact, product(minor(bx, by, cx, cy), az), 1.0);
  add(exact, product(minor(cx, cy, ax, ay), bz), 1.0);
  add(exact, product(minor(ax, ay, bx, by), cz), 1.0);
  return exact.sign();
}

}  // namespace spherical_param::internal
