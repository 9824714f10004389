#include "rotation_search.h"

#include "index_loops.h"
#include "pi.h"
#include "space_filling_curve.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace spherical_param::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Number of rotations that are tried: nearest ones are about 19 degrees apart.
constexpr Index kRotations = 2048;
/// Samples of each surface for comparing them.
constexpr Index kCoarseSamples = 64;
/// The best rotations that are farther than kApart [rad] from each other are improved.
constexpr std::size_t kCandidates = 8;
constexpr double kApart = 0.25;
constexpr Index kMediumSamples = 256;
/// The best result is improved once more.
constexpr Index kFineSamples = 4096;

struct Sample {
  Vector3d direction;
  Vector3d position;
};

/// A surface centred and scaled to area 1, as a function on the sphere.
class UnitSurface {
public:
  explicit UnitSurface(const SphereSurface& surface) : surface_(surface) {
    const Positions& points = surface.points();
    const Triangles& triangles = surface.triangles();
    const Vector3d origin = points.col(triangles(0, 0));
    Vector3d sum = Vector3d::Zero();
    for (Index t = 0; t < triangles.cols(); ++t) {
      areas_.push_back(0.5 * areaNormal(points, triangles, t).norm());
      area_ += areas_.back();
      for (const Index v : triangles.col(t))
        sum += areas_.back() / 3.0 * (points.col(v) - origin);
    }
    center_ = area_ > 0.0 ? Vector3d(origin + sum / area_) : origin;
    scale_ = area_ > 0.0 ? 1.0 / std::sqrt(area_) : 1.0;
    Positions middles(3, triangles.cols());
    for (Index t = 0; t < middles.cols(); ++t)
      middles.col(t) = blend(surface.sphere(), {t, Vector3d::Ones()});
    order_ = mortonOrder(middles);
  }

  /// A position on the flat triangles.
  Vector3d at(const SphereLocation& location) const {
    return scale_ * (blend(surface_.points(), location) - center_);
  }
  Vector3d at(const Vector3d& direction) const { return at(surface_.locate(direction)); }

  /// Samples spread over the surface by its area: along a curve over the sphere, in equal parts.
  Indexed<Sample> samples(Index count) const {
    Indexed<Sample> samples;
    std::size_t i = 0;
    double before = 0.0;
    for (Index s = 0; s < count; ++s) {
      const double wanted = (s + 0.5) / count * area_;
      while (i + 1 < order_.size() && before + areas_[order_[i]] < wanted)
        before += areas_[order_[i++]];
      // M. Roberts' sequence R2, folded into the triangle.
      double a = std::fmod(0.5 + 0.7548776662466927 * s, 1.0);
      double b = std::fmod(0.5 + 0.5698402909980532 * s, 1.0);
      if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
      }
      const SphereLocation location{order_[i], {1.0 - a - b, a, b}};
      samples.push_back({blend(surface_.sphere(), location).normalized(), at(location)});
    }
    return samples;
  }

private:
  Vector3d blend(const Positions& corners, const SphereLocation& location) const {
    return internal::blend(corners, surface_.triangles(), location.triangle, location.weights);
  }

  const SphereSurface& surface_;
  Indexed<double> areas_;
  std::vector<Index> order_;  ///< of the triangles along a curve over the sphere
  double area_ = 0.0;
  Vector3d center_;
  double scale_;
};

/// The identity, then rotations spread evenly over all there are (M. Alexa: "Super-Fibonacci
/// Spirals: Fast, Low-Discrepancy Sampling of SO(3)", 2022).
Matrix3d rotationOf(Index i) {
  if (i == 0)
    return Matrix3d::Identity();
  constexpr double phi = 1.4142135623730951;
  constexpr double psi = 1.533751168755204288118041;
  const double s = i - 0.5;
  const double t = s / (kRotations - 1);
  const double alpha = 2.0 * kPi * s / phi;
  const double beta = 2.0 * kPi * s / psi;
  const double r = std::sqrt(t);
  const double big = std::sqrt(1.0 - t);
  return Eigen::Quaterniond(big * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                            big * std::sin(beta))
      .normalized()
      .toRotationMatrix();
}

using DirectionPairs = std::vector<std::pair<Vector3d, Vector3d>>;

/// What is minimised by a rotation, as a sum of squares: the distances of samples of each surface
/// from the other one, and those of pairs.
class Distances {
public:
  Distances(const UnitSurface& first, const UnitSurface& second, Index samples,
            const DirectionPairs& pairs, int threads)
      : first_(first), second_(second), of_first_(first.samples(samples)),
        of_second_(second.samples(samples)), pairs_(pairs), threads_(threads) {}

  /// The weighted differences, 3 of each sample and pair.
  void at(const Matrix3d& rotation, Eigen::VectorXd& values) const {
    const Index n = indexCount(of_first_);
    const double weight = std::sqrt(0.5 / n);
    forEachIndex(2 * of_first_.size(), threads_, [&](Index i) {
      const Sample& sample = i < n ? of_first_[i] : of_second_[i - n];
      values.segment<3>(Eigen::Index{3} * i) =
          weight * ((i < n ? second_.at(Vector3d(rotation * sample.direction))
                           : first_.at(Vector3d(rotation.transpose() * sample.direction))) -
                    sample.position);
    });
    for (Index i = 0; i < indexCount(pairs_); ++i)
      values.segment<3>(6 * n + 3 * i) =
          (rotation * entry(pairs_, i).first - entry(pairs_, i).second) /
          std::sqrt(indexCount(pairs_));
  }
  double errorAt(const Matrix3d& rotation) const {
    Eigen::VectorXd values(this->values());
    at(rotation, values);
    return values.squaredNorm();
  }

  /// Descends from a rotation. \return the least error, and the rotation that has it
  std::pair<double, Matrix3d> descend(const Matrix3d& from) const {
    Descent descent{this, from};
    Eigen::NumericalDiff<Descent> with_derivative(descent);
    Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Descent>> search(with_derivative);
    search.parameters.xtol = 1e-10;
    Eigen::VectorXd turn = Eigen::VectorXd::Zero(3);
    search.minimize(turn);
    return {search.fnorm * search.fnorm, descent.turned(turn)};
  }

  Index values() const { return 6 * indexCount(of_first_) + 3 * indexCount(pairs_); }

private:
  /// The distances as a function of a turn, which follows a rotation [axis times rad].
  struct Descent {
    using Scalar = double;
    using InputType = Eigen::VectorXd;
    using ValueType = Eigen::VectorXd;
    using JacobianType = Eigen::MatrixXd;
    enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

    const Distances* distances;
    Matrix3d from;

    Matrix3d turned(const Eigen::VectorXd& turn) const {
      const double angle = turn.norm();
      const Vector3d axis = angle > 0.0 ? Vector3d(turn / angle) : Vector3d(Vector3d::UnitX());
      return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis).toRotationMatrix() * from)
          .normalized()
          .toRotationMatrix();
    }
    int inputs() const { return 3; }
    int values() const { return distances->values(); }
    int operator()(const Eigen::VectorXd& turn, Eigen::VectorXd& values) const {
      distances->at(turned(turn), values);
      return 0;
    }
  };

  const UnitSurface& first_;
  const UnitSurface& second_;
  Indexed<Sample> of_first_;
  Indexed<Sample> of_second_;
  const DirectionPairs& pairs_;
  int threads_;
};

/// The rotations of least error that are apart from each other.
std::vector<Matrix3d> chooseStarts(const Distances& distances, int threads) {
  Indexed<std::pair<double, Index>> ranked(kRotations);
  forEachTask(ranked.size(), threads, [&](std::size_t i) {
    const auto number = static_cast<Index>(i);
    ranked[i] = {distances.errorAt(rotationOf(number)), number};
  });
  std::sort(ranked.begin(), ranked.end());
  std::vector<Matrix3d> starts;
  for (const auto& [error, i] : ranked) {
    const Matrix3d rotation = rotationOf(i);
    if (starts.size() < kCandidates &&
        std::all_of(starts.begin(), starts.end(), [&](const Matrix3d& start) {
          return Eigen::AngleAxisd(start.transpose() * rotation).angle() > kApart;
        }))
      starts.push_back(rotation);
  }
  return starts;
}

}  // namespace

double alignmentError(const SphereSurface& first, const SphereSurface& second,
                      const Matrix3d& rotation, int threads) {
  const UnitSurface unit_first(first);
  const UnitSurface unit_second(second);
  return Distances(unit_first, unit_second, kFineSamples, {}, threads).errorAt(rotation);
}

Matrix3d searchRotation(const SphereSurface& first, const SphereSurface& second,
                        const DirectionPairs& pairs, int threads, const FractionReport& report) {
  const UnitSurface unit_first(first);
  const UnitSurface unit_second(second);
  const auto distances = [&](Index samples, int used) {
    return Distances(unit_first, unit_second, samples, pairs, used);
  };
  reportFraction(report, 0.0);
  const std::vector<Matrix3d> starts =
      chooseStarts(distances(kCoarseSamples, 1), threadCount(threads, kRotations * kCoarseSamples));
  reportFraction(report, 0.0);
  const Distances medium = distances(kMediumSamples, 1);
  std::vector<std::pair<double, Matrix3d>> ends(starts.size());
  forEachTask(starts.size(), threadCount(threads, starts.size() * kMediumSamples),
              [&](std::size_t i) { ends[i] = medium.descend(starts[i]); });
  reportFraction(report, 0.5);
  const auto best =
      std::min_element(ends.begin(), ends.end(),
                       [](const auto& one, const auto& other) { return one.first < other.first; });
  Matrix3d rotation = distances(kFineSamples, threads).descend(best->second).second;
  reportFraction(report, 1.0);
  return rotation;
}

}  // namespace spherical_param::internal
