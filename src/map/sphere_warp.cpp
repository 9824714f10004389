#include "sphere_warp.h"

#include "corner_table.h"
#include "index_loops.h"
#include "tangent_basis.h"
#include "triangle_geometry.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// Landmarks collide if they come nearer to each other than this fraction of their distance at the
/// beginning or at the end, whichever is less. Detours around each other do not help.
constexpr double kMinApproach = 0.25;
/// Number of places on two paths where the distance is examined.
constexpr int kPathSamples = 48;
/// The longest and the shortest step along the paths [fraction of the path].
constexpr double kMaxStep = 1.0 / 16.0;
constexpr double kMinStep = 1e-3;
/// Radius of a field's support: a multiple of the distances between landmarks, and of their paths'
/// lengths.
constexpr double kSupport = 4.0;
/// Rounds over flipped triangles after a step.
constexpr int kRounds = 12;
/// Number of steps towards the middle of the kernel of a vertex's ring.
constexpr int kKernelSteps = 40;

/// The path of a landmark: an arc.
struct Path {
  Landmark* landmark;
  Vector3d from, to;
  Vector3d along;  ///< the direction in which it begins
  double angle;    ///< [rad]

  Path(const Positions& sphere, Landmark& of)
      : landmark(&of), from(sphere.col(of.vertex)), to(of.target) {
    const Vector3d cross = from.cross(to);
    angle = std::atan2(cross.norm(), from.dot(to));
    // Between antipodes any arc will do.
    along = cross.norm() > 1e-12 ? Vector3d(cross.cross(from).normalized())
                                 : Vector3d(tangentBasis(from).col(0));
  }

  Vector3d at(double t) const {
    return t >= 1.0 ? to : Vector3d(std::cos(t * angle) * from + std::sin(t * angle) * along);
  }
};

bool collide(const Path& one, const Path& other) {
  const double begin = (one.from - other.from).norm();
  const double apart = kMinApproach * std::min(begin, (one.to - other.to).norm());
  if (begin - one.angle - other.angle > apart)
    return false;
  for (int s = 1; s < kPathSamples; ++s)
    if ((one.at(1.0 * s / kPathSamples) - other.at(1.0 * s / kPathSamples)).norm() < apart)
      return true;
  return false;
}

/// A tangential field on the sphere: the sum of vectors, each weighted by the distance from its
/// centre, without the part along the radius.
class Field {
public:
  /// The field that has given tangential values at its centres. \param support [chord]
  Field(const Positions& centers, const Positions& values, double support)
      : centers_(centers), weights_(3, centers.cols()), support_(support) {
    const Eigen::Index n = centers.cols();
    Indexed<TangentBasis> bases;
    for (Eigen::Index i = 0; i < n; ++i)
      bases.push_back(tangentBasis(centers.col(i)));
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd wanted(2 * n);
    for (Index i = 0; i < n; ++i) {
      wanted.segment<2>(2 * i) = bases[i].transpose() * values.col(i);
      for (Index j = 0; j <= i; ++j)
        gram.block<2, 2>(2 * i, 2 * j) =
            kernel(centers.col(i) - centers.col(j)) * (bases[i].transpose() * bases[j]);
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(gram);
    const Eigen::VectorXd weights = solver.solve(wanted);
    for (Index i = 0; i < n; ++i)
      weights_.col(i) = bases[i] * weights.segment<2>(2 * i);
  }

  Vector3d at(const Vector3d& x) const {
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index j = 0; j < centers_.cols(); ++j)
      sum += kernel(x - centers_.col(j)) * weights_.col(j);
    return sum - x.dot(sum) * x;
  }

private:
  double kernel(const Vector3d& difference) const {
    const double squared = difference.squaredNorm() / (support_ * support_);
    if (squared >= 1.0)
      return 0.0;
    const double r = std::sqrt(squared);
    const double rest = (1.0 - r) * (1.0 - r);
    return rest * rest * (4.0 * r + 1.0);
  }

  Positions centers_;
  Positions weights_;
  double support_;
};

/// Untangles flipped triangles by moves of single vertices.
class Untangler {
public:
  Untangler(const Triangles& triangles, std::size_t vertex_count, int threads)
      : triangles_(triangles), corners_(triangles, vertex_count, 1), threads_(threads) {}

  /// Untangles what it can. \return the first triangle that is still flipped, if there is one
  std::optional<Index> untangle(Positions& sphere, const Indexed<char>& is_fixed) const {
    std::vector<Index> bad = flipped(sphere);
    for (int round = 0; round < kRounds && !bad.empty(); ++round) {
      std::vector<Index> vertices;
      for (const Index t : bad)
        for (const Index v : triangles_.col(t))
          vertices.push_back(v);
      if (round > 3) {
        // Their neighbours make room.
        for (std::size_t i = 0, n = vertices.size(); i < n; ++i)
          forEachSide(vertices[i], [&](Index a, Index) { vertices.push_back(a); });
      }
      sortUnique(vertices);
      for (const Index v : vertices)
        if (is_fixed[v] == 0)
          relax(sphere, v);
      bad = flipped(sphere);
    }
    return bad.empty() ? std::nullopt : std::optional(bad.front());
  }

private:
  /// Flipped triangles, ascending.
  std::vector<Index> flipped(const Positions& sphere) const {
    const std::size_t count = columnCount(triangles_);
    return collectBlocks<Index>(count, threadCount(threads_, count), {},
                                [&](Index begin, Index end, std::vector<Index>& found) {
                                  for (Index t = begin; t < end; ++t)
                                    if (isFlipped(sphere, triangles_, t))
                                      found.push_back(t);
                                });
  }

  /// Calls visit(a, b) for the sides opposite to v of the triangles around it.
  template <typename Visit>
  void forEachSide(Index v, const Visit& visit) const {
    corners_.forEachCorner(v, [&](Index t, Index k) {
      visit(triangles_(nextCorner(k), t), triangles_(previousCorner(k), t));
    });
  }

  /// Moves a vertex from its neighbours' mean towards the middle of the kernel of their polygon, by
  /// steps off the nearest of its sides, to where the fewest triangles around it are flipped.
  void relax(Positions& sphere, Index v) const {
    const Vector3d old = sphere.col(v);
    const auto count_flipped = [&](const Vector3d& place) {
      int count = 0;
      forEachSide(v, [&](Index a, Index b) {
        count += isOutward(place, sphere.col(a), sphere.col(b)) ? 0 : 1;
      });
      return count;
    };
    Vector3d place = Vector3d::Zero();
    forEachSide(v, [&](Index a, Index) { place += sphere.col(a); });
    place.normalize();
    const int before = count_flipped(old);
    // Where nothing is gained, half the way to the mean loosens what is stuck.
    Vector3d best = before > 0 ? Vector3d((old + place).normalized()) : old;
    int least = before;
    for (int step = 0; step < kKernelSteps && least > 0; ++step) {
      const int count = count_flipped(place);
      if (count < least) {
        least = count;
        best = place;
      }
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
    }
    sphere.col(v) = best;
  }

  const Triangles& triangles_;
  CornerTable corners_;
  int threads_;
};

/// The motion of some landmarks, and of the sphere with them.
class Motion {
public:
  Motion(Positions sphere, const std::vector<Path>& paths, const Untangler& untangler, int threads)
      : sphere_(std::move(sphere)), paths_(paths), untangler_(untangler), threads_(threads),
        is_fixed_(columnCount(sphere_), 0), support_(supportOf(paths)) {
    for (const Path& path : paths)
      is_fixed_[path.landmark->vertex] = 1;
  }

  /// Moves the sphere until all landmarks are at the ends of their paths.
  /// \return a triangle that stays flipped however short the step is, if there is one
  std::optional<Index> run(const FractionReport& report) {
    double step = kMaxStep;
    for (double t = 0.0; t < 1.0;) {
      const Positions before = sphere_;
      const double goal = std::min(1.0, t + step);
      carry(goal);
      if (const std::optional<Index> stuck = untangler_.untangle(sphere_, is_fixed_)) {
        if (step < kMinStep)
          return stuck;
        sphere_ = before;
        step *= 0.5;
        continue;
      }
      t = goal;
      step = std::min(kMaxStep, 2.0 * step);
      reportFraction(report, 0.99 * t);
    }
    return std::nullopt;
  }

  const Positions& sphere() const { return sphere_; }
  double worst() const { return worst_; }

private:
  /// Wider than the paths, so that the surroundings are not squeezed; at most the diameter.
  static double supportOf(const std::vector<Path>& paths) {
    double widest = 0.0;
    for (const Path& path : paths) {
      Vector3d nearest = Vector3d::Constant(2.0);
      for (const Path& other : paths)
        if (&other != &path) {
          nearest[0] = std::min(nearest[0], (path.from - other.from).norm());
          nearest[1] = std::min(nearest[1], (path.to - other.to).norm());
        }
      widest = std::max({widest, path.angle, nearest[0], nearest[1]});
    }
    return std::min(2.0, kSupport * widest);
  }

  /// One step of all vertices, to a time on the paths.
  void carry(double goal) {
    const Index n = indexCount(paths_);
    Positions places(3, n);
    Positions values(3, n);
    for (Index i = 0; i < n; ++i) {
      const Vector3d place = sphere_.col(entry(paths_, i).landmark->vertex);
      const Vector3d end = entry(paths_, i).at(goal);
      const Vector3d way = end / std::max(0.5, end.dot(place)) - place;
      places.col(i) = place;
      values.col(i) = way - place.dot(way) * place;
    }
    const Field field(places, values, support_);
    forEachIndex(
        is_fixed_.size(), threads_,
        [&](Index v) {
          const Vector3d x = sphere_.col(v);
          sphere_.col(v) = (x + field.at(x)).normalized();
        },
        paths_.size());
    for (const Path& path : paths_) {
      auto place = sphere_.col(path.landmark->vertex);
      const Vector3d end = path.at(goal);
      worst_ = std::max(worst_, (place - end).norm());
      place = end;
    }
  }

  Positions sphere_;
  const std::vector<Path>& paths_;
  const Untangler& untangler_;
  int threads_;
  Indexed<char> is_fixed_;
  double support_;  ///< of the fields [chord]
  double worst_ = 0.0;
};

}  // namespace

SphereWarp moveLandmarks(Positions& sphere, const Triangles& triangles,
                         std::vector<Landmark>& landmarks, int threads,
                         const FractionReport& report) {
  const Untangler untangler(triangles, columnCount(sphere), threads);
  SphereWarp warp;
  warp.is_flipped = untangler.untangle(sphere, Indexed<char>(columnCount(sphere), 0)).has_value();
  std::vector<Path> paths;
  for (Landmark& landmark : landmarks) {
    const Path path(sphere, landmark);
    if (std::any_of(paths.begin(), paths.end(),
                    [&](const Path& other) { return collide(path, other); }))
      landmark.fault = "its way on the sphere crosses that of an earlier pair";
    else
      paths.push_back(path);
  }
  double reported = 0.0;
  // A motion that starts again must not report less than before.
  const FractionReport ascending = [&](double fraction) {
    reported = std::max(reported, fraction);
    reportFraction(report, reported);
  };
  while (!paths.empty()) {
    Motion motion(sphere, paths, untangler, threads);
    const std::optional<Index> stuck = motion.run(ascending);
    if (!stuck) {
      sphere = motion.sphere();
      warp = {false, motion.worst()};
      break;
    }
    // The landmark nearest to what stays flipped is in the way.
    const Vector3d place = motion.sphere().col(triangles(0, *stuck));
    const auto nearest =
        std::min_element(paths.begin(), paths.end(), [&](const Path& one, const Path& other) {
          return (one.to - place).norm() < (other.to - place).norm();
        });
    nearest->landmark->fault =
        "no motion of the sphere was found that takes it to its place without a fold";
    paths.erase(nearest);
  }
  reportFraction(report, 1.0);
  return warp;
}

}  // namespace spherical_param::internal
