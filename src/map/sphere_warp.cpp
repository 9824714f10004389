#include "sphere_warp.h"

#include "corner_table.h"
#include "index_loops.h"
#include "pi.h"
#include "tangent_basis.h"
#include "triangle_geometry.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// A step x -> (x + s(x)) / |x + s(x)| of a tangential field is locally one to one where |s|^2 +
/// |Ds|^2 < 1, as I + (s, Ds) then has an inverse; and a map of the sphere that is so everywhere is
/// one to one. The field is examined at some places: the bound leaves room for those between.
constexpr double kMaxWarpSlope = 0.4;
/// Landmarks collide if they come nearer to each other than this fraction of the least of their
/// distances at the beginning and the end.
constexpr double kMinApproach = 0.25;
/// Places on their ways where their distances are examined.
constexpr std::size_t kPathSamples = 48;
/// Detours that are tried [rad at the middle, as a fraction of the way and 0.1].
constexpr double kDetours[] = {0.0, 0.2, -0.2, 0.45, -0.45, 0.9, -0.9};
/// The shortest step along the paths [fraction of the path].
constexpr double kMinStep = 1e-3;
/// A field's support, in distances of landmarks and in ways that they go [chord].
constexpr double kSupport = 4.0;
/// Rounds over flipped triangles after each step, and at the end: as many after each step take half
/// as long again and honour no more pairs.
constexpr int kStepRounds = 4;
constexpr int kEndRounds = 30;
/// Steps towards the middle of the kernel of a vertex's ring.
constexpr int kKernelSteps = 40;

/// The way of a landmark: an arc, pushed aside most in its middle.
struct Path {
  Vector3d from, to;
  Vector3d axis;                                   ///< of the arc
  double angle = 0.0;                              ///< of the arc [rad]
  double detour = 0.0;                             ///< [rad]
  std::array<Vector3d, kPathSamples - 1> samples;  ///< evenly, without the ends

  Path(const Vector3d& begin, const Vector3d& end) : from(begin), to(end) {
    const Vector3d cross = begin.cross(end);
    angle = std::atan2(cross.norm(), begin.dot(end));
    // Between antipodes any arc will do, and without a way any axis.
    axis =
        cross.norm() > 1e-12 ? Vector3d(cross.normalized()) : Vector3d(tangentBasis(begin).col(0));
    bend(0.0);
  }

  void bend(double aside) {
    detour = aside;
    for (unsigned s = 0; s < samples.size(); ++s)
      samples[s] = at((s + 1.0) / kPathSamples);
  }

  /// No place on it is farther from its beginning [rad].
  double reach() const { return angle + std::abs(detour); }

  Vector3d at(double t) const {
    if (t >= 1.0)
      return to;
    const Vector3d along = axis.cross(from).normalized();
    const Vector3d on_arc = std::cos(t * angle) * from + std::sin(t * angle) * along;
    const double aside = detour * std::sin(kPi * t);
    return (std::cos(aside) * on_arc + std::sin(aside) * axis).normalized();
  }
};

/// How much too near to each other two ways come: 0 for not at all, 1 for a crash.
double conflictOf(const Path& one, const Path& other) {
  const double apart =
      kMinApproach * std::min((one.from - other.from).norm(), (one.to - other.to).norm());
  if ((one.from - other.from).norm() - one.reach() - other.reach() > apart)
    return 0.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < one.samples.size(); ++s)
    nearest = std::min(nearest, (one.samples[s] - other.samples[s]).squaredNorm());
  nearest = std::sqrt(nearest);
  return nearest < apart ? 1.0 - nearest / apart : 0.0;
}

/// Sends landmarks that would collide on detours. \return which still would, most of all
std::optional<std::size_t> planPaths(std::vector<Path>& paths,
                                     const std::vector<std::size_t>& active, int threads) {
  const auto conflict_of = [&](std::size_t i) {
    double sum = 0.0;
    for (const std::size_t j : active)
      if (j != i)
        sum += conflictOf(paths[i], paths[j]);
    return sum;
  };
  std::vector<double> conflicts(paths.size(), 0.0);
  const auto find_worst = [&] {
    const int used = threadCount(threads, active.size() * active.size());
    forEachTask(active.size(), used,
                [&](std::size_t k) { conflicts[active[k]] = conflict_of(active[k]); });
    return std::max_element(conflicts.begin(), conflicts.end());
  };
  auto worst = find_worst();
  for (double before = std::numeric_limits<double>::infinity(); *worst < before;) {
    if (*worst == 0.0)
      return std::nullopt;
    before = *worst;
    for (const std::size_t i : active) {
      double least = conflict_of(i);
      if (least == 0.0)
        continue;
      Path& path = paths[i];
      double best = path.detour;
      for (const double fraction : kDetours) {
        path.bend(fraction * (path.angle + 0.1));
        const double conflict = conflict_of(i);
        if (conflict < least) {
          least = conflict;
          best = path.detour;
        }
      }
      path.bend(best);
    }
    worst = find_worst();
  }
  return worst - conflicts.begin();
}

/// A tangential field on the sphere: the sum of vectors of which each counts the less the farther
/// its centre is, without the part along the radius.
class Field {
public:
  /// The field that has given tangential values at its centres. \param support [chord]
  Field(const Positions& centers, const Positions& values, double support)
      : centers_(centers), inverse_support_(1.0 / support) {
    const Eigen::Index n = centers.cols();
    Indexed<TangentBasis> bases;
    for (Eigen::Index i = 0; i < n; ++i)
      bases.push_back(tangentBasis(centers.col(i)));
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd wanted(2 * n);
    for (Index i = 0; i < n; ++i) {
      const TangentBasis& basis = bases[i];
      wanted.segment<2>(2 * i) = basis.transpose() * values.col(i);
      for (Index j = 0; j <= i; ++j) {
        const double r = (centers.col(i) - centers.col(j)).norm() * inverse_support_;
        if (r < 1.0)
          gram.block<2, 2>(2 * i, 2 * j) = kernel(r) * (basis.transpose() * bases[j]);
      }
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(gram);
    Eigen::VectorXd weights = solver.solve(wanted);
    // Refined: the conditions are to hold to the last digits, though centres may be near.
    for (int i = 0; i < 2; ++i)
      weights += solver.solve(wanted - gram.selfadjointView<Eigen::Lower>() * weights);
    weights_.resize(3, n);
    for (Index i = 0; i < n; ++i)
      weights_.col(i) = bases[i] * weights.segment<2>(2 * i);
    is_finite_ = weights_.allFinite();
  }

  bool isFinite() const { return is_finite_; }

  Vector3d at(const Vector3d& x) const {
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index j = 0; j < centers_.cols(); ++j) {
      const double squared =
          (x - centers_.col(j)).squaredNorm() * inverse_support_ * inverse_support_;
      if (squared < 1.0)
        sum += kernel(std::sqrt(squared)) * weights_.col(j);
    }
    return sum - x.dot(sum) * x;
  }

  /// |s|^2 + |Ds|^2, the Frobenius norm.
  double slopeAt(const Vector3d& x) const {
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();
    for (Eigen::Index j = 0; j < centers_.cols(); ++j) {
      const Vector3d from = (x - centers_.col(j)) * inverse_support_;
      const double r = from.norm();
      if (r >= 1.0)
        continue;
      sum += kernel(r) * weights_.col(j);
      // phi'(r) / r = -20 (1 - r)^3
      const double fall = -20.0 * (1.0 - r) * (1.0 - r) * (1.0 - r) * inverse_support_;
      derivative += fall * weights_.col(j) * from.transpose();
    }
    const TangentBasis basis = tangentBasis(x);
    const double along = x.dot(sum);
    double squared = (sum - along * x).squaredNorm();
    for (int k = 0; k < 2; ++k) {
      const Vector3d e = basis.col(k);
      const Vector3d d = derivative * e;
      squared += (d - (x.dot(d) + e.dot(sum)) * x - along * e).squaredNorm();
    }
    return squared;
  }

private:
  static double kernel(double r) {
    const double rest = (1.0 - r) * (1.0 - r);
    return rest * rest * (4.0 * r + 1.0);
  }

  Positions centers_;
  Positions weights_;
  double inverse_support_;
  bool is_finite_ = true;
};

bool isFlipped(const Positions& sphere, Index a, Index b, Index c) {
  return !isOutward(sphere.col(a), sphere.col(b), sphere.col(c));
}

/// Untangles flipped triangles by moves of single vertices.
class Untangler {
public:
  Untangler(const Triangles& triangles, const Indexed<char>& is_fixed)
      : triangles_(triangles), is_fixed_(is_fixed), corners_(triangles, is_fixed.size(), 1) {}

  /// Flipped triangles, ascending.
  std::vector<Index> flipped(const Positions& sphere, int threads) const {
    const auto m = static_cast<std::size_t>(triangles_.cols());
    std::vector<std::vector<Index>> of_block((m + kBlockSize - 1) / kBlockSize);
    forEachBlock(m, threadCount(threads, m),
                 [&](std::size_t block, std::size_t begin, std::size_t end) {
                   for (std::size_t t = begin; t < end; ++t) {
                     const auto corners = triangles_.col(static_cast<Eigen::Index>(t));
                     if (isFlipped(sphere, corners[0], corners[1], corners[2]))
                       of_block[block].push_back(static_cast<Index>(t));
                   }
                 });
    std::vector<Index> all;
    for (const std::vector<Index>& some : of_block)
      all.insert(all.end(), some.begin(), some.end());
    return all;
  }

  /// Untangles what it can. \return the triangles that are still flipped
  std::vector<Index> untangle(Positions& sphere, int rounds, int threads, Index& moved) const {
    std::vector<Index> bad = flipped(sphere, threads);
    for (int round = 0; round < rounds && !bad.empty(); ++round) {
      std::vector<Index> vertices;
      for (const Index t : bad)
        for (int k = 0; k < 3; ++k)
          vertices.push_back(triangles_(k, t));
      if (round > 3) {
        // Their neighbours make room.
        for (std::size_t i = 0, n = vertices.size(); i < n; ++i)
          forEachSide(vertices[i], [&](Index a, Index) { vertices.push_back(a); });
      }
      sortUnique(vertices);
      for (const Index v : vertices)
        if (is_fixed_[v] == 0 && relax(sphere, v))
          ++moved;
      bad = flipped(sphere, threads);
    }
    return bad;
  }

private:
  /// Calls visit(a, b) for the sides opposite to v of the triangles around it.
  template <typename Visit>
  void forEachSide(Index v, const Visit& visit) const {
    corners_.forEachCorner(v, [&](Index t, Index k) {
      visit(triangles_((k + 1) % 3, t), triangles_((k + 2) % 3, t));
    });
  }

  int flippedAround(const Positions& sphere, Index v) const {
    int count = 0;
    forEachSide(v, [&](Index a, Index b) { count += isFlipped(sphere, v, a, b) ? 1 : 0; });
    return count;
  }

  /// Moves a vertex towards its neighbours' mean, or to where its triangle with the least margin
  /// has most, if fewer triangles around are flipped then, or as many and it is in between.
  bool relax(Positions& sphere, Index v) const {
    const Vector3d old = sphere.col(v);
    Vector3d mean = Vector3d::Zero();
    forEachSide(v, [&](Index a, Index) { mean += sphere.col(a); });
    mean.normalize();
    const int before = flippedAround(sphere, v);
    Vector3d best = old;
    int least = before;
    for (const double fraction : {0.25, 0.5, 0.75, 1.0}) {
      sphere.col(v) = ((1.0 - fraction) * old + fraction * mean).normalized();
      const int count = flippedAround(sphere, v);
      if (count < least) {
        least = count;
        best = sphere.col(v);
      }
    }
    if (least > 0) {
      // The middle of the kernel of the polygon of neighbours, by steps off the nearest of its
      // sides.
      Vector3d place = mean;
      for (int step = 0; step < kKernelSteps && least > 0; ++step) {
        double nearest = std::numeric_limits<double>::infinity();
        Vector3d inward = Vector3d::Zero();
        double size = 0.0;
        forEachSide(v, [&](Index a, Index b) {
          const Vector3d normal = sphere.col(a).cross(sphere.col(b));
          const double length = normal.norm();
          size = std::max(size, (sphere.col(a) - place).norm());
          if (length > 0.0 && normal.dot(place) / length < nearest) {
            nearest = normal.dot(place) / length;
            inward = normal / length;
          }
        });
        place = (place + size * 0.5 / (step + 2) * inward).normalized();
        sphere.col(v) = place;
        const int count = flippedAround(sphere, v);
        if (count < least) {
          least = count;
          best = place;
        }
      }
    }
    if (least == before && before > 0)
      best = (0.5 * old + 0.5 * mean).normalized();  // loosens what is stuck
    sphere.col(v) = best;
    return best != old;
  }

  const Triangles& triangles_;
  const Indexed<char>& is_fixed_;
  CornerTable corners_;
};

/// Directions that are spread evenly.
Positions spreadDirections(int n) {
  Positions directions(3, n);
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    const double angle = kPi * (3.0 - std::sqrt(5.0)) * i;
    const double radius = std::sqrt(1.0 - z * z);
    directions.col(i) << radius * std::cos(angle), radius * std::sin(angle), z;
  }
  return directions;
}

/// Distance of each column to the nearest other one; of a single one 2, the largest there is.
Indexed<double> nearestDistances(const Positions& places) {
  Indexed<double> nearest(columnCount(places), 2.0);
  for (Index i = 0; i < places.cols(); ++i)
    for (Index j = 0; j < i; ++j) {
      const double distance = (places.col(i) - places.col(j)).norm();
      for (const Index k : {i, j})
        nearest[k] = std::min(nearest[k], distance);
    }
  return nearest;
}

/// The largest slope of a field over some places, and at which landmark it is, about.
std::pair<double, Index> steepestOf(const Field& field, const Positions& places,
                                    const Positions& spread, int threads) {
  const Indexed<double> nearest = nearestDistances(places);
  const Index n = indexCount(nearest);
  constexpr int around = 6;
  constexpr int of_each = 2 * around + 1;
  Eigen::VectorXd slopes(of_each * n + spread.cols());
  const auto examine = [&](Index s) {
    const Index i = s / of_each;
    const Index k = s % of_each;
    Vector3d x = i < n ? places.col(i) : spread.col(s - of_each * n);
    if (i < n && k > 0) {
      const TangentBasis basis = tangentBasis(x);
      const double angle = kPi / 3.0 * k;
      const double far = nearest[i] * (k <= around ? 0.5 : 0.25);
      x = (x + far * (std::cos(angle) * basis.col(0) + std::sin(angle) * basis.col(1)))
              .normalized();
    }
    slopes[s] = field.slopeAt(x);
  };
  forEachIndex(static_cast<std::size_t>(slopes.size()), threads, examine, nearest.size());
  Index steepest = 0;
  const double slope = slopes.maxCoeff(&steepest);
  return {slope, std::min(steepest / of_each, n)};
}

/// The motion of all landmarks, and of the sphere with them. It begins again without a landmark
/// that cannot come to its place.
class LandmarkMotion {
public:
  LandmarkMotion(const Positions& sphere, const Triangles& triangles,
                 const std::vector<Landmark>& landmarks, int threads, const FractionReport& report)
      : sphere_(sphere), triangles_(triangles), landmarks_(landmarks), threads_(threads),
        report_(report), spread_(spreadDirections(512)), is_fixed_(columnCount(sphere), 0),
        untangler_(triangles, is_fixed_) {}

  SphereWarp run() {
    warp_.reasons.resize(landmarks_.size());
    for (;;) {
      planAll();
      begin();
      std::optional<std::size_t> stuck = followPaths();
      if (!stuck && !active_.empty())
        stuck = arrive();
      if (!stuck)
        break;
      giveUp(*stuck, "no motion of the sphere was found that takes it to its place without a fold");
    }
    reportFraction(report_, 1.0);
    return std::move(warp_);
  }

private:
  void giveUp(std::size_t landmark, const char* reason) {
    warp_.reasons[landmark] = reason;
    is_fixed_[landmarks_[landmark].vertex] = 0;
  }

  const Path& pathOf(Index i) const { return paths_[active_[i]]; }
  Index vertexOf(Index i) const { return landmarks_[active_[i]].vertex; }
  Index count() const { return indexCount(active_); }

  /// Finds paths that keep the landmarks apart, and gives up those that have none.
  void planAll() {
    active_.clear();
    paths_.clear();
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      paths_.emplace_back(sphere_.col(landmarks_[i].vertex), landmarks_[i].target);
      if (warp_.reasons[i].empty()) {
        active_.push_back(i);
        is_fixed_[landmarks_[i].vertex] = 1;
      }
    }
    while (!active_.empty()) {
      const std::optional<std::size_t> worst = planPaths(paths_, active_, threads_);
      if (!worst)
        break;
      giveUp(*worst, "no way was found to its place that keeps it apart from the other pairs");
      active_.erase(std::find(active_.begin(), active_.end(), *worst));
    }
  }

  /// Puts everything back to the beginning, and chooses the support of the fields.
  void begin() {
    warp_.sphere = sphere_;
    warp_.steps = 0;
    warp_.worst = 0.0;
    warp_.untangled = 0;
    places_.resize(3, count());
    ends_.resize(3, count());
    double longest = 0.0;
    for (Index i = 0; i < count(); ++i) {
      places_.col(i) = pathOf(i).from;
      ends_.col(i) = pathOf(i).to;
      longest = std::max(longest, pathOf(i).angle + 2.0 * std::abs(pathOf(i).detour));
    }
    support_ = 0.0;
    for (const Positions& where : {places_, ends_})
      for (const double distance : nearestDistances(where))
        support_ = std::max(support_, kSupport * distance);
    // Wider than what is moved, so that it is not squeezed; more than the diameter is no use.
    support_ = std::min(2.0, std::max(support_, kSupport * longest));
    untangle(kEndRounds);
  }

  /// Triangles that are still flipped after this number of rounds.
  std::vector<Index> untangle(int rounds) {
    return untangler_.untangle(warp_.sphere, rounds, threads_, warp_.untangled);
  }

  /// Moves the sphere in steps until all landmarks are at the ends of their paths. \return the
  /// landmark that no short step takes further, if there is one
  std::optional<std::size_t> followPaths() {
    double t = 0.0;
    double step = 1.0;
    // The last step goes nowhere but to the targets, from where rounding has left the landmarks.
    for (bool is_last = active_.empty(); !is_last;) {
      is_last = t >= 1.0;
      const double goal = is_last ? 1.0 : std::min(1.0, t + step);
      const auto [values, farthest] = motionTo(goal);
      if (is_last && farthest == 0.0)
        break;
      const Field field(places_, values, support_);
      const auto [slope, where] = steepestOf(field, places_, spread_, threads_);
      if (!field.isFinite() || !(slope <= kMaxWarpSlope * kMaxWarpSlope)) {
        step = 0.5 * (goal - t);
        if (is_last || step < kMinStep)
          return active_[std::min(where, count() - 1)];
        continue;
      }
      carry(field);
      t = goal;
      step *= 2.0;
      // A motion that begins again does not report less than before.
      reported_ = std::max(reported_, 0.99 * t);
      reportFraction(report_, reported_);
    }
    return std::nullopt;
  }

  /// The tangential vectors that take the landmarks to a time on their paths, and the length of the
  /// longest [chord].
  std::pair<Positions, double> motionTo(double time) const {
    Positions values(3, count());
    double farthest = 0.0;
    for (Index i = 0; i < count(); ++i) {
      const Vector3d place = places_.col(i);
      const Vector3d next = pathOf(i).at(time);
      values.col(i) = next / std::max(0.5, next.dot(place)) - place;
      values.col(i) -= place.dot(values.col(i)) * place;
      farthest = std::max(farthest, (next - place).norm());
    }
    return {values, farthest};
  }

  /// One step of all vertices.
  void carry(const Field& field) {
    const auto move = [&](Index v) {
      const Vector3d x = warp_.sphere.col(v);
      warp_.sphere.col(v) = (x + field.at(x)).normalized();
    };
    forEachIndex(is_fixed_.size(), threads_, move, active_.size());
    for (Index i = 0; i < count(); ++i)
      places_.col(i) = warp_.sphere.col(vertexOf(i));
    untangle(kStepRounds);
    ++warp_.steps;
  }

  /// Puts the landmarks exactly on their targets. \return the landmark that is nearest to a
  /// triangle that stays flipped, if there is one: it is in the way
  std::optional<std::size_t> arrive() {
    for (Index i = 0; i < count(); ++i) {
      warp_.worst = std::max(warp_.worst, (places_.col(i) - ends_.col(i)).norm());
      warp_.sphere.col(vertexOf(i)) = ends_.col(i);
    }
    const std::vector<Index> bad = untangle(kEndRounds);
    if (bad.empty())
      return std::nullopt;
    Vector3d middle = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      middle += warp_.sphere.col(triangles_(k, bad[0]));
    Index nearest = 0;
    (ends_.colwise() - middle.normalized()).colwise().squaredNorm().minCoeff(&nearest);
    return active_[nearest];
  }

  const Positions& sphere_;
  const Triangles& triangles_;
  const std::vector<Landmark>& landmarks_;
  int threads_;
  const FractionReport& report_;
  Positions spread_;
  Indexed<char> is_fixed_;
  Untangler untangler_;
  SphereWarp warp_;
  Indexed<std::size_t> active_;  ///< landmarks that are not given up
  std::vector<Path> paths_;      ///< of all landmarks
  Positions places_;             ///< of the active landmarks, now
  Positions ends_;               ///< their targets
  double support_ = 0.0;         ///< of the fields [chord]
  double reported_ = 0.0;
};

}  // namespace

Index countFlipped(const Positions& sphere, const Triangles& triangles, int threads) {
  return sumOfIndices(columnCount(triangles), threads, Index{0},
                      [&](Index t) { return isFlipped(sphere, triangles, t) ? 1 : 0; });
}

SphereWarp moveLandmarks(const Positions& sphere, const Triangles& triangles,
                         const std::vector<Landmark>& landmarks, int threads,
                         const FractionReport& report) {
  return LandmarkMotion(sphere, triangles, landmarks, threads, report).run();
}

}  // namespace spherical_param::internal
