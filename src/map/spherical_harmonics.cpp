#include "spherical_param/map/spherical_harmonics.h"

#include "index_loops.h"
#include "input_checks.h"
#include "pi.h"
#include "spherical_param/errors.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

using internal::kPi;

void checkDegree(const std::string& function, int degree) {
  internal::checkRange(function + ": degree", degree, 0, 512);
}

Eigen::Index place(int l, int m) {
  return Eigen::Index{l} * l + l + m;
}

Eigen::Index coefficientCount(int degree) {
  return Eigen::Index{degree + 1} * (degree + 1);
}

/// Associated Legendre functions of the first kind, without the phase (-1)^m and so normalised that
/// with cos(m phi) or sin(m phi) they are orthonormal on the sphere. By the recurrence over l,
/// which is stable (S. A. Holmes and W. E. Featherstone, 2002, section 2.1), from values that
/// underflow only where all that follow are negligible.
class Legendre {
public:
  explicit Legendre(int degree) : degree_(degree), starts_(degree + 1) {
    double start = 1.0 / std::sqrt(4.0 * kPi);
    for (int m = 0; m <= degree; ++m) {
      if (m > 0)
        start *= std::sqrt((m == 1 ? 2.0 : 1.0) * (2.0 * m + 1.0) / (2.0 * m));
      starts_[m] = start;
      for (int l = m; l <= degree; ++l)
        factors_.push_back(
            l == m ? 0.0
                   : std::sqrt((2.0 * l - 1.0) * (2.0 * l + 1.0) / (1.0 * (l - m) * (l + m))));
    }
  }

  int degree() const { return degree_; }

  /// Calls visit(l, value) for l = m ... degree.
  ///
  /// \param z of a unit vector; \param power sine of its angle with the axis to the power of m.
  template <typename Visit>
  void forEachDegree(int m, double z, double power, const Visit& visit) const {
    const double* factors = factors_.data() + (m * (2 * degree_ + 3 - m)) / 2;
    double before = 0.0;
    double value = starts_[m] * power;
    visit(m, value);
    for (int i = 1; m + i <= degree_; ++i) {
      const double last = factors[i - 1];
      const double next = factors[i] * (z * value - (i > 1 ? before / last : 0.0));
      before = value;
      value = next;
      visit(m + i, value);
    }
  }

private:
  int degree_;
  Eigen::VectorXd starts_;       ///< l = m, without the power of the sine; one for each m
  std::vector<double> factors_;  ///< of the recurrence, l = m ... degree for each m
};

/// Values of all harmonics at a direction.
template <typename Values>
void evaluateAll(const Legendre& legendre, const Vector3d& direction, Values& values) {
  const Vector3d u = direction.stableNormalized();
  const double sine = std::hypot(u.x(), u.y());
  const double x = sine > 0.0 ? u.x() / sine : 1.0;
  const double y = sine > 0.0 ? u.y() / sine : 0.0;
  double power = 1.0;
  double cosine_m = 1.0;
  double sine_m = 0.0;
  for (int m = 0; m <= legendre.degree(); ++m) {
    legendre.forEachDegree(m, u.z(), power, [&](int l, double value) {
      values[place(l, m)] = value * cosine_m;
      if (m > 0)
        values[place(l, -m)] = value * sine_m;
    });
    power *= sine;
    const double turned = cosine_m * x - sine_m * y;
    sine_m = sine_m * x + cosine_m * y;
    cosine_m = turned;
  }
}

/// Nodes and weights of the Gauss-Legendre rule on [-1, 1]; the nodes ascend.
struct GaussRule {
  Eigen::VectorXd nodes;
  Eigen::VectorXd weights;

  explicit GaussRule(int count) : nodes(count), weights(count) {
    for (int i = 0; i < (count + 1) / 2; ++i) {
      double z = std::cos(kPi * (i + 0.75) / (count + 0.5));
      double slope = 1.0;
      constexpr int most_steps = 10;  // converges in about 4
      for (int step = 0; step < most_steps; ++step) {
        double before = 0.0;
        double value = 1.0;
        for (int l = 1; l <= count; ++l) {
          const double next = ((2.0 * l - 1.0) * z * value - (l - 1.0) * before) / l;
          before = value;
          value = next;
        }
        slope = count * (z * value - before) / (z * z - 1.0);
        const double change = value / slope;
        z -= change;
        if (std::abs(change) < 1e-15)
          break;
      }
      if (2 * i + 1 == count)
        z = 0.0;
      const double weight = 2.0 / ((1.0 - z * z) * slope * slope);
      nodes[i] = -z;
      nodes[count - 1 - i] = z;
      weights[i] = weights[count - 1 - i] = weight;
    }
  }
};

/// The quadrature on the sphere: rings of directions, equal steps along each.
class Rings {
public:
  /// \param degree twice as many nodes as the product of two series needs, and some more: the
  ///               surface is no series.
  explicit Rings(int degree)
      : degree_(degree), around_(4 * degree + 64), rule_(2 * degree + 32), legendre_(degree) {
    for (int k = 0; k < around_; ++k) {
      cosines_.push_back(std::cos(2.0 * kPi * k / around_));
      sines_.push_back(std::sin(2.0 * kPi * k / around_));
    }
  }

  Eigen::Index count() const { return rule_.nodes.size(); }

  Positions directions() const {
    Positions result(3, count() * around_);
    Eigen::Index i = 0;
    for (Index ring = 0; ring < count(); ++ring)
      for (Index k = 0; k < around_; ++k)
        result.col(i++) << sineOf(ring) * cosines_[k], sineOf(ring) * sines_[k], rule_.nodes[ring];
    return result;
  }

  /// The coefficients of values at the directions.
  Positions coefficients(const Positions& values, int threads) const {
    // First along the rings: column ring * (2 degree + 1) + degree + m.
    Positions waves(3, count() * (2 * degree_ + 1));
    forEachTask(count(), threads, [&](Index ring) {
      for (int m = 0; m <= degree_; ++m) {
        Vector3d of_cosine = Vector3d::Zero();
        Vector3d of_sine = Vector3d::Zero();
        forEachPlace(m, [&](int k, double cosine, double sine) {
          of_cosine += cosine * values.col(column(ring, k));
          of_sine += sine * values.col(column(ring, k));
        });
        const double weight = rule_.weights[ring] * 2.0 * kPi / around_;
        waves.col(wave(ring, m)) = weight * of_cosine;
        if (m > 0)
          waves.col(wave(ring, -m)) = weight * of_sine;
      }
    });
    // Then across them, each order by one thread.
    Positions result = Positions::Zero(3, coefficientCount(degree_));
    forEachTask(degree_ + 1, threads, [&](Index m) {
      for (Index ring = 0; ring < count(); ++ring)
        legendre_.forEachDegree(m, rule_.nodes[ring], std::pow(sineOf(ring), m),
                                [&](int l, double value) {
                                  result.col(place(l, m)) += value * waves.col(wave(ring, m));
                                  if (m > 0)
                                    result.col(place(l, -m)) += value * waves.col(wave(ring, -m));
                                });
    });
    return result;
  }

  /// Root mean square over the sphere of the distance of values from a series.
  double residual(const Positions& values, const Positions& coefficients, int threads) const {
    Eigen::VectorXd sums(count());
    forEachTask(count(), threads, [&](Index ring) {
      Positions rest(3, around_);
      for (int k = 0; k < around_; ++k)
        rest.col(k) = values.col(column(ring, k));
      for (int m = 0; m <= degree_; ++m) {
        Vector3d of_cosine = Vector3d::Zero();
        Vector3d of_sine = Vector3d::Zero();
        legendre_.forEachDegree(m, rule_.nodes[ring], std::pow(sineOf(ring), m),
                                [&](int l, double value) {
                                  of_cosine += value * coefficients.col(place(l, m));
                                  if (m > 0)
                                    of_sine += value * coefficients.col(place(l, -m));
                                });
        forEachPlace(m, [&](int k, double cosine, double sine) {
          rest.col(k) -= cosine * of_cosine + sine * of_sine;
        });
      }
      sums[ring] = rule_.weights[ring] / (2.0 * around_) * rest.squaredNorm();
    });
    double sum = 0.0;
    for (const double of_ring : sums)
      sum += of_ring;
    return std::sqrt(sum);
  }

private:
  /// 1 - z^2 as a product: it has all digits near the poles.
  double sineOf(Index ring) const {
    const double z = rule_.nodes[ring];
    return std::sqrt((1.0 - z) * (1.0 + z));
  }
  Eigen::Index column(Eigen::Index ring, int k) const { return ring * around_ + k; }
  Eigen::Index wave(Eigen::Index ring, int m) const {
    return ring * (2 * degree_ + 1) + degree_ + m;
  }
  /// Calls visit(k, cos(m phi), sin(m phi)) for the places along a ring.
  template <typename Visit>
  void forEachPlace(int m, const Visit& visit) const {
    int angle = 0;
    for (int k = 0; k < around_; ++k) {
      visit(k, cosines_[angle], sines_[angle]);
      angle += m;
      angle -= angle >= around_ ? around_ : 0;
    }
  }
  /// Calls work(i) for each ring or order.
  template <typename Work>
  void forEachTask(Eigen::Index tasks, int threads, const Work& work) const {
    const auto places = static_cast<std::size_t>(count() * around_);
    internal::forEachTask(static_cast<std::size_t>(tasks), internal::threadCount(threads, places),
                          [&](std::size_t i) { work(static_cast<Index>(i)); });
  }

  int degree_;
  int around_;
  GaussRule rule_;
  Legendre legendre_;
  internal::Indexed<double> cosines_;
  internal::Indexed<double> sines_;
};

}  // namespace

Eigen::VectorXd sphericalHarmonicsAt(const Vector3d& direction, int degree) {
  checkDegree("sphericalHarmonicsAt", degree);
  internal::checkDirections("sphericalHarmonicsAt", direction);
  Eigen::VectorXd values(coefficientCount(degree));
  evaluateAll(Legendre(degree), direction, values);
  return values;
}

SphericalHarmonics computeSphericalHarmonics(const SphereSurface& surface, int degree,
                                             int threads) {
  checkDegree("computeSphericalHarmonics", degree);
  const Rings rings(degree);
  const Positions values = surface.evaluate(rings.directions()).positions;
  SphericalHarmonics result;
  result.degree = degree;
  result.coefficients = rings.coefficients(values, threads);
  result.rms_residual = rings.residual(values, result.coefficients, threads);
  return result;
}

Positions evaluateSphericalHarmonics(const SphericalHarmonics& harmonics,
                                     const Positions& directions, int threads) {
  constexpr const char* function = "evaluateSphericalHarmonics";
  checkDegree(function, harmonics.degree);
  const Eigen::Index terms = coefficientCount(harmonics.degree);
  if (harmonics.coefficients.cols() != terms)
    throw InvalidInput(std::string(function) + ": " +
                       std::to_string(harmonics.coefficients.cols()) +
                       " coefficients; a series of degree " + std::to_string(harmonics.degree) +
                       " has " + std::to_string(terms));
  internal::checkDirections(function, directions);
  const Legendre legendre(harmonics.degree);
  const std::size_t count = internal::columnCount(directions);
  Positions result(3, directions.cols());
  internal::forEachBlock(count, internal::threadCount(threads, count, internal::kBlockSize), {},
                         [&](std::size_t, std::size_t begin, std::size_t end) {
                           Eigen::VectorXd values(terms);
                           for (auto i = static_cast<Index>(begin); i < static_cast<Index>(end);
                                ++i) {
                             evaluateAll(legendre, directions.col(i), values);
                             result.col(i).noalias() = harmonics.coefficients * values;
                           }
                         });
  return result;
}

}  // namespace spherical_param
