#include "rotation_search.h"

#include "index_loops.h"
#include "pi.h"
#include "space_filling_curve.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace spherical_param::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Rotations that are tried: nearest ones are some 12 degrees apart.
constexpr Index kRotations = 8192;
/// Samples of each surface that they are compared at.
constexpr Index kCoarseSamples = 160;
/// Those of least error are improved, if they are not near a better one [rad].
constexpr std::size_t kCandidates = 12;
constexpr double kApart = 0.25;
constexpr Index kMediumSamples = 512;
/// The best of these is improved once more.
constexpr Index kFineSamples = 4096;
constexpr int kMaxSteps = 60;
/// A descent has ended when its steps are as short [rad].
constexpr double kMinTurn = 1e-9;

struct Sample {
  Vector3d direction;
  Vector3d position;  ///< of the centred surface of area 1
};

/// A surface centred and scaled to area 1, as a function on the sphere.
class UnitSurface {
public:
  explicit UnitSurface(const SphereSurface& surface) : surface_(surface) {
    const Positions& points = surface.points();
    const Triangles& triangles = surface.triangles();
    const Vector3d origin = points.col(triangles(0, 0));
    Vector3d sum = Vector3d::Zero();
    double area = 0.0;
    areas_.reserve(columnCount(triangles));
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const Vector3d a = points.col(triangles(0, t)) - origin;
      const Vector3d b = points.col(triangles(1, t)) - origin;
      const Vector3d c = points.col(triangles(2, t)) - origin;
      areas_.push_back(0.5 * (b - a).cross(c - a).norm());
      area += areas_.back();
      sum += areas_.back() / 3.0 * (a + b + c);
    }
    area_ = area;
    center_ = area > 0.0 ? Vector3d(origin + sum / area) : origin;
    scale_ = area > 0.0 ? 1.0 / std::sqrt(area) : 1.0;
  }

  /// Position at a direction, and its derivative by the direction, of the flat triangles.
  Vector3d at(const Vector3d& direction, Matrix3d* derivative) const {
    const SphereLocation location = surface_.locate(direction);
    Matrix3d corners;
    Matrix3d points;
    for (int k = 0; k < 3; ++k) {
      const Index v = surface_.triangles()(k, location.triangle);
      corners.col(k) = surface_.sphere().col(v);
      points.col(k) = normalized(surface_.points().col(v));
    }
    Vector3d position = points * location.weights;
    if (derivative != nullptr) {
      // The direction is corners * beta, the position points * beta / sum(beta).
      const Matrix3d inverse = corners.inverse();
      const double sum = (inverse * direction).sum();
      *derivative = (points * inverse - position * inverse.colwise().sum()) / sum;
      if (!derivative->allFinite())
        derivative->setZero();
    }
    return position;
  }

  /// Samples spread over the surface by its area: along a curve over the sphere, in equal parts.
  std::vector<Sample> samples(Index count) const {
    const Triangles& triangles = surface_.triangles();
    Positions middles(3, triangles.cols());
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      middles.col(t) = surface_.sphere().col(triangles(0, t)) +
                       surface_.sphere().col(triangles(1, t)) +
                       surface_.sphere().col(triangles(2, t));
    const std::vector<Index> order = mortonOrder(middles);
    std::vector<Sample> samples;
    std::size_t i = 0;
    double before = 0.0;
    for (Index s = 0; s < count; ++s) {
      const double wanted = (s + 0.5) / count * area_;
      while (i + 1 < order.size() && before + areas_[order[i]] < wanted)
        before += areas_[order[i++]];
      // M. Roberts' sequence R2, folded into the triangle.
      double a = 0.5 + 0.7548776662466927 * s;
      double b = 0.5 + 0.5698402909980532 * s;
      a -= std::floor(a);
      b -= std::floor(b);
      if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
      }
      const auto corners = triangles.col(order[i]);
      const Vector3d weights(1.0 - a - b, a, b);
      Sample sample{Vector3d::Zero(), Vector3d::Zero()};
      for (int k = 0; k < 3; ++k) {
        sample.direction += weights[k] * surface_.sphere().col(corners[k]);
        sample.position += weights[k] * normalized(surface_.points().col(corners[k]));
      }
      sample.direction.normalize();
      samples.push_back(sample);
    }
    return samples;
  }

private:
  Vector3d normalized(const Vector3d& point) const { return scale_ * (point - center_); }

  const SphereSurface& surface_;
  Indexed<double> areas_;
  double area_ = 0.0;
  Vector3d center_;
  double scale_ = 1.0;
};

/// Positions in a square onto which the octahedron is unfolded; in between they are interpolated.
class PositionTable {
public:
  PositionTable(const UnitSurface& surface, int threads) : positions_(std::size_t{kSide * kSide}) {
    forEachIndex(positions_.size(), threads, [&](Index i) {
      const Index row = i / kSide;
      const double s = 2.0 * (i % kSide) / (kSide - 1) - 1.0;
      const double t = 2.0 * row / (kSide - 1) - 1.0;
      Vector3d direction(s, t, 1.0 - std::abs(s) - std::abs(t));
      if (direction.z() < 0.0) {
        direction.x() = std::copysign(1.0 - std::abs(t), s);
        direction.y() = std::copysign(1.0 - std::abs(s), t);
      }
      positions_[i] = surface.at(direction, nullptr);
    });
  }

  Vector3d at(const Vector3d& direction) const {
    const double sum = direction.cwiseAbs().sum();
    double s = direction.x() / sum;
    double t = direction.y() / sum;
    if (direction.z() < 0.0) {
      const double folded = std::copysign(1.0 - std::abs(t), s);
      t = std::copysign(1.0 - std::abs(s), t);
      s = folded;
    }
    const double x = std::clamp((s + 1.0) / 2.0 * (kSide - 1), 0.0, kSide - 1.0);
    const double y = std::clamp((t + 1.0) / 2.0 * (kSide - 1), 0.0, kSide - 1.0);
    const Index column = std::min(static_cast<Index>(x), kSide - 2);
    const Index row = std::min(static_cast<Index>(y), kSide - 2);
    const double right = x - column;
    const double down = y - row;
    const Vector3d* cell = &positions_[row * kSide + column];
    return (1.0 - down) * ((1.0 - right) * cell[0] + right * cell[1]) +
           down * ((1.0 - right) * cell[kSide] + right * cell[kSide + 1]);
  }

private:
  static constexpr Index kSide = 97;
  Indexed<Vector3d> positions_;
};

/// Rotations spread evenly over all there are (M. Alexa: "Super-Fibonacci Spirals: Fast,
/// Low-Discrepancy Sampling of SO(3)", 2022), after that of nothing.
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

Matrix3d rotatedBy(const Vector3d& turn, const Matrix3d& rotation) {
  const double angle = turn.norm();
  if (angle == 0.0)
    return rotation;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * rotation)
      .normalized()
      .toRotationMatrix();
}

Matrix3d crossWith(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

using DirectionPairs = std::vector<std::pair<Vector3d, Vector3d>>;

/// What is minimised, near a rotation: with e = error, g = its gradient by a turn of the rotation,
/// h = that of Gauss and Newton for its second derivative.
struct LocalModel {
  double error = 0.0;
  Vector3d gradient = Vector3d::Zero();
  Matrix3d hessian = Matrix3d::Zero();

  LocalModel& operator+=(const LocalModel& other) {
    error += other.error;
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
  void add(const Vector3d& residual, const Matrix3d& derivative, double weight) {
    error += weight * residual.squaredNorm();
    gradient += 2.0 * weight * derivative.transpose() * residual;
    hessian += 2.0 * weight * derivative.transpose() * derivative;
  }
};

class Problem {
public:
  Problem(const UnitSurface& first, const UnitSurface& second, Index count)
      : first_(first), second_(second), of_first_(first.samples(count)),
        of_second_(second.samples(count)) {}

  LocalModel model(const Matrix3d& rotation, const DirectionPairs& pairs, bool with_derivative,
                   int threads) const {
    const std::size_t count = of_first_.size();
    const double weight = 0.5 / static_cast<double>(count);
    LocalModel model = sumOfBlocks(
        2 * count, threadCount(threads, 2 * count), LocalModel(),
        [&](std::size_t begin, std::size_t end) {
          LocalModel part;
          Matrix3d by_direction;
          Matrix3d* const derivative = with_derivative ? &by_direction : nullptr;
          by_direction.setZero();
          for (std::size_t i = begin; i < end; ++i) {
            if (i < count) {
              const Sample& sample = of_first_[i];
              const Vector3d u = rotation * sample.direction;
              const Vector3d residual = second_.at(u, derivative) - sample.position;
              part.add(residual, -by_direction * crossWith(u), weight);
            } else {
              const Sample& sample = of_second_[i - count];
              const Vector3d u = rotation.transpose() * sample.direction;
              const Vector3d residual = first_.at(u, derivative) - sample.position;
              part.add(residual, by_direction * rotation.transpose() * crossWith(sample.direction),
                       weight);
            }
          }
          return part;
        });
    for (const auto& [from, to] : pairs) {
      const Vector3d u = rotation * from;
      model.add(u - to, -crossWith(u), 1.0 / static_cast<double>(pairs.size()));
    }
    return model;
  }

  /// Follows the error down (K. Levenberg, 1944; D. Marquardt, 1963).
  std::pair<double, Matrix3d> descend(Matrix3d rotation, const DirectionPairs& pairs,
                                      int threads) const {
    LocalModel here = model(rotation, pairs, true, threads);
    double damping = 1e-3;
    for (int step = 0; step < kMaxSteps; ++step) {
      Matrix3d damped = here.hessian;
      damped.diagonal() += damping * here.hessian.diagonal();
      damped.diagonal().array() += 1e-12;
      const Vector3d turn = -damped.inverse() * here.gradient;
      if (!turn.allFinite() || turn.norm() < kMinTurn)
        break;
      if (turn.norm() < 0.5) {
        const Matrix3d next = rotatedBy(turn, rotation);
        const LocalModel there = model(next, pairs, true, threads);
        if (there.error < here.error) {
          here = there;
          rotation = next;
          damping = std::max(1e-9, damping * 0.2);
          continue;
        }
      }
      damping *= 6.0;
    }
    return {here.error, rotation};
  }

  const std::vector<Sample>& ofFirst() const { return of_first_; }
  const std::vector<Sample>& ofSecond() const { return of_second_; }

private:
  const UnitSurface& first_;
  const UnitSurface& second_;
  std::vector<Sample> of_first_;
  std::vector<Sample> of_second_;
};

double angleBetween(const Matrix3d& one, const Matrix3d& other) {
  return Eigen::AngleAxisd(one.transpose() * other).angle();
}

struct RankedRotation {
  double error;
  Index number;
  bool operator<(const RankedRotation& other) const {
    return error != other.error ? error < other.error : number < other.number;
  }
};

/// All rotations that are tried, least error first.
std::vector<RankedRotation> rankRotations(const UnitSurface& first, const UnitSurface& second,
                                          const DirectionPairs& pairs, int threads) {
  const PositionTable table_first(first, threads);
  const PositionTable table_second(second, threads);
  const Problem coarse(first, second, kCoarseSamples);
  Indexed<RankedRotation> candidates(kRotations);
  forEachIndex(kRotations, threads, [&](Index i) {
    const Matrix3d rotation = rotationOf(i);
    double sum = 0.0;
    for (const Sample& sample : coarse.ofFirst())
      sum += (table_second.at(rotation * sample.direction) - sample.position).squaredNorm();
    for (const Sample& sample : coarse.ofSecond())
      sum +=
          (table_first.at(rotation.transpose() * sample.direction) - sample.position).squaredNorm();
    double error = 0.5 * sum / kCoarseSamples;
    for (const auto& [from, to] : pairs)
      error += (rotation * from - to).squaredNorm() / static_cast<double>(pairs.size());
    candidates[i] = {error, i};
  });
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

/// Whether a rotation is farther than `apart` [rad] from all of some others.
bool isApart(const Matrix3d& rotation, const std::vector<Matrix3d>& others, double apart) {
  return std::all_of(others.begin(), others.end(),
                     [&](const Matrix3d& other) { return angleBetween(rotation, other) > apart; });
}

/// The best rotations that are apart from each other.
std::vector<Matrix3d> chooseStarts(const std::vector<RankedRotation>& candidates) {
  std::vector<Matrix3d> starts;
  for (const RankedRotation& candidate : candidates) {
    const Matrix3d rotation = rotationOf(candidate.number);
    if (isApart(rotation, starts, kApart))
      starts.push_back(rotation);
    if (starts.size() == kCandidates)
      break;
  }
  return starts;
}

}  // namespace

double alignmentError(const SphereSurface& first, const SphereSurface& second,
                      const Matrix3d& rotation, int threads) {
  const UnitSurface unit_first(first);
  const UnitSurface unit_second(second);
  return Problem(unit_first, unit_second, kFineSamples).model(rotation, {}, false, threads).error;
}

Matrix3d searchRotation(const SphereSurface& first, const SphereSurface& second,
                        const DirectionPairs& pairs, int threads, const FractionReport& report) {
  const UnitSurface unit_first(first);
  const UnitSurface unit_second(second);
  reportFraction(report, 0.0);
  const std::vector<RankedRotation> candidates =
      rankRotations(unit_first, unit_second, pairs, threads);
  reportFraction(report, 0.0);

  const std::vector<Matrix3d> starts = chooseStarts(candidates);
  std::vector<std::pair<double, Matrix3d>> ends(starts.size());
  {
    const Problem medium(unit_first, unit_second, kMediumSamples);
    const int used = threadCount(threads, starts.size() * kMediumSamples);
    forEachTask(starts.size(), used,
                [&](std::size_t i) { ends[i] = medium.descend(starts[i], pairs, 1); });
  }
  reportFraction(report, 0.5);
  const auto best =
      std::min_element(ends.begin(), ends.end(),
                       [](const auto& one, const auto& other) { return one.first < other.first; });
  Matrix3d rotation =
      Problem(unit_first, unit_second, kFineSamples).descend(best->second, pairs, threads).second;
  reportFraction(report, 1.0);
  return rotation;
}

}  // namespace spherical_param::internal
