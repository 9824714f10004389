#include "sphere_triangulation.h"

#include "incremental_delaunay.h"
#include "parallel.h"
#include "progress.h"
#include "space_filling_curve.h"
#include "sphere_mesh.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"

#include <Eigen/Geometry>

#include <libqhull_r/libqhull_r.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::SphereMesh;

/// Relative bound under which a predicate counts as undecided: some hundred times the rounding
/// error of its few operations.
constexpr double kPredicateTolerance = 1e-13;

/// Points between reports.
constexpr std::size_t kReportedPoints = std::size_t{1} << 12U;

/// The working memory of one run of reentrant qhull.
class Qhull {
public:
  Qhull() : messages_(std::fopen("/dev/null", "w")) {
    if (messages_ == nullptr)
      messages_ = std::tmpfile();
    // Without a file qhull would print its messages.
    if (messages_ == nullptr)
      throw ComputeError("triangulateSphere: no file can be opened; close some");
    qh_zero(&state_, messages_);
  }
  ~Qhull() {
    qh_freeqhull(&state_, !qh_ALL);
    // Tables that qhull itself forgets if there was no memory for both.
    if (state_.qhmem.LASTsize == 0) {
      std::free(state_.qhmem.freelists);
      std::free(state_.qhmem.sizetable);
    }
    int current = 0;
    int total = 0;
    qh_memfreeshort(&state_, &current, &total);
    std::fclose(messages_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// Runs on 3 x n points, which must outlive this; returns qhull's exit code.
  int run(const Positions& points) {
    // Qt: triangles only. Pp: no precision warnings.
    std::string command = "qhull Qt Pp";
    return qh_new_qhull(&state_, 3, static_cast<int>(points.cols()),
                        const_cast<coordT*>(points.data()), False, command.data(), messages_,
                        messages_);
  }

  /// The facets as triangles, oriented as qhull has them.
  Triangles triangles() {
    std::vector<Index> corners;
    for (const facetT* facet = state_.facet_list; facet != nullptr && facet->next != nullptr;
         facet = facet->next) {
      if (qh_setsize(&state_, facet->vertices) != 3)
        return {};
      for (int k = 0; k < 3; ++k) {
        const auto* vertex = static_cast<const vertexT*>(facet->vertices->e[k].p);
        corners.push_back(static_cast<Index>(qh_pointid(&state_, vertex->point)));
      }
      if ((facet->toporient ? 1 : 0) != qh_ORIENTclock)
        std::swap(corners[corners.size() - 1], corners[corners.size() - 2]);
    }
    return Eigen::Map<Triangles>(corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  }

private:
  qhT state_{};
  std::FILE* messages_;  ///< qhull insists on writing its messages somewhere
};

/// The convex hull as a closed oriented genus-0 mesh over some of the points; none if qhull fails
/// on the points or its triangles are not such a mesh.
std::optional<Triangles> convexHull(const Positions& directions) {
  auto qhull = std::make_unique<Qhull>();
  const int exit_code = qhull->run(directions);
  if (exit_code == qh_ERRmem)
    throw ComputeError("triangulateSphere: qhull ran out of memory; use fewer points");
  if (exit_code != qh_ERRnone)
    return std::nullopt;
  Triangles triangles = qhull->triangles();
  if (signedVolume(directions, triangles) < 0.0)
    flipOrientation(triangles);
  MeshTopology topology = checkTopology(triangles, static_cast<std::size_t>(directions.cols()));
  topology.unused_vertices.clear();  // they are put back later
  if (!topology.isSphere())
    return std::nullopt;
  return triangles;
}

/// Four points far from each other as a tetrahedron.
Triangles firstTetrahedron(const Positions& directions) {
  const auto farthest = [](const Eigen::RowVectorXd& measure,
                           const std::vector<Eigen::Index>& taken) {
    Eigen::RowVectorXd rest = measure;
    for (const Eigen::Index i : taken)
      rest[i] = -1.0;
    Eigen::Index best = 0;
    rest.maxCoeff(&best);
    return best;
  };
  const Eigen::Vector3d a = directions.col(0);
  const Positions from_a = directions.colwise() - a;
  const Eigen::Index i = farthest(from_a.colwise().norm(), {0});
  const Eigen::Vector3d ab = from_a.col(i);
  Eigen::RowVectorXd measure(directions.cols());
  for (Eigen::Index p = 0; p < directions.cols(); ++p)
    measure[p] = ab.cross(from_a.col(p)).norm();
  const Eigen::Index j = farthest(measure, {0, i});
  const Eigen::Vector3d normal = ab.cross(from_a.col(j));
  for (Eigen::Index p = 0; p < directions.cols(); ++p)
    measure[p] = std::abs(normal.dot(from_a.col(p)));
  const Eigen::Index k = farthest(measure, {0, i, j});

  auto b = static_cast<Index>(i);
  auto c = static_cast<Index>(j);
  const auto d = static_cast<Index>(k);
  if (normal.dot(from_a.col(k)) > 0.0)
    std::swap(b, c);
  Triangles tetrahedron(3, 4);
  tetrahedron.col(0) << 0, b, c;
  tetrahedron.col(1) << 0, c, d;
  tetrahedron.col(2) << 0, d, b;
  tetrahedron.col(3) << d, c, b;
  return tetrahedron;
}

/// Inserts points into a triangulation of the sphere. Predicates are evaluated in differences of
/// nearby points, so that they keep their relative accuracy in small clusters. They decide where a
/// point goes; that the mesh stays a closed genus-0 manifold does not depend on them.
class PointInserter {
public:
  PointInserter(const Positions& directions, const Triangles& triangles)
      : directions_(directions), mesh_(triangles, static_cast<std::size_t>(directions.cols())) {
    for (Index t = 0; t < mesh_.size(); ++t)
      for (int k = 0; k < 3; ++k)
        interior_ += point(mesh_.vertex(t, k));
    interior_ /= 3.0 * mesh_.size();
  }

  void insert(const std::vector<Index>& points, const internal::FractionReport& report) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i % kReportedPoints == 0)
        internal::reportFraction(report,
                                 static_cast<double>(i) / static_cast<double>(points.size()));
      const Index p = points[i];
      const auto parts = mesh_.split(locate(p), p);
      last_ = parts[0];
      legalize({parts.begin(), parts.end()});
    }
  }

  /// Inserts a point beside a vertex at the same place.
  void insertAt(Index p, Index vertex) {
    const auto parts = mesh_.split(mesh_.triangleAt(vertex), p);
    legalize({parts.begin(), parts.end()});
  }

  Triangles triangles() const { return mesh_.triangles(); }

private:
  Eigen::Vector3d point(Index i) const { return directions_.col(i); }

  /// Positive if c is to the left of the side from a to b, seen from outside towards the interior
  /// point: the sine of the angle at a, about; 0 within rounding.
  double leftOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c) const {
    const Eigen::Vector3d ab = b - a;
    const Eigen::Vector3d ac = c - a;
    const double scale = ab.norm() * ac.norm();
    const double side = (a - interior_).dot(ab.cross(ac));
    return std::abs(side) <= kPredicateTolerance * scale ? 0.0 : side / scale;
  }

  /// Whether d is inside the circle of a, b, c (counter-clockwise) on the unit sphere beyond
  /// rounding. The plain determinant of the convex hull loses all digits for points closer than
  /// 1e-8; here the height of q above the tangent plane at d is replaced by its exact value on the
  /// sphere, (q - d) . d = -|q - d|^2 / 2.
  bool isInsideCircle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) const {
    const Eigen::Vector3d tangent = d.unitOrthogonal();
    const Eigen::Vector3d cotangent = d.cross(tangent);
    double scale = 1.0;
    double longest = 0.0;
    const auto lifted = [&](const Eigen::Vector3d& q) {
      const Eigen::Vector3d edge = q - d;
      const double length = edge.norm();
      scale *= length;
      longest = std::max(longest, length);
      return Eigen::Vector3d(edge.dot(tangent), edge.dot(cotangent), length * length / 2.0);
    };
    const Eigen::Vector3d la = lifted(a);
    const Eigen::Vector3d lb = lifted(b);
    const Eigen::Vector3d lc = lifted(c);
    return la.dot(lb.cross(lc)) > kPredicateTolerance * scale * longest;
  }

  /// The triangle that holds a point: a walk across sides that have the point on their far side.
  Index locate(Index p) {
    const Eigen::Vector3d target = point(p);
    const auto side = [&](Index t, int k) {
      return leftOf(point(mesh_.vertex(t, (k + 1) % 3)), point(mesh_.vertex(t, (k + 2) % 3)),
                    target);
    };
    Index t = last_;
    const auto steps = static_cast<Index>(1000.0 + 10.0 * std::sqrt(mesh_.size()));
    for (Index step = 0; step < steps; ++step) {
      int across = -1;
      // Begins at another side in each step: with rounding, a fixed order could run in circles.
      for (int k = step % 3, tried = 0; tried < 3 && across < 0; k = (k + 1) % 3, ++tried)
        if (side(t, k) < 0.0)
          across = k;
      if (across < 0)
        return t;
      t = mesh_.neighbor(t, across);
    }
    // A flat or badly rounded mesh: take the triangle which the point is least outside of.
    Index best = t;
    double best_side = -2.0;
    for (t = 0; t < mesh_.size() && best_side < 0.0; ++t) {
      const double worst = std::min({side(t, 0), side(t, 1), side(t, 2)});
      if (worst > best_side) {
        best_side = worst;
        best = t;
      }
    }
    return best;
  }

  /// Flips the sides opposite to a new vertex (corner 0 of each triangle) until they are locally
  /// Delaunay (C. L. Lawson, 1977).
  void legalize(std::vector<Index> pending) {
    while (!pending.empty()) {
      const Index t = pending.back();
      pending.pop_back();
      const Index other = mesh_.neighbor(t, 0);
      const Eigen::Vector3d c = point(mesh_.vertex(t, 0));
      const Eigen::Vector3d a = point(mesh_.vertex(t, 1));
      const Eigen::Vector3d b = point(mesh_.vertex(t, 2));
      const Eigen::Vector3d d = point(mesh_.vertex(other, mesh_.oppositeCorner(t, 0)));
      // The flip adds a side from c to d: only where both new triangles face outward.
      if (isInsideCircle(b, a, d, c) && leftOf(a, d, c) > 0.0 && leftOf(d, b, c) > 0.0 &&
          mesh_.flip(t, 0)) {
        pending.push_back(t);
        pending.push_back(other);
      }
    }
  }

  const Positions& directions_;
  SphereMesh mesh_;
  Eigen::Vector3d interior_ = Eigen::Vector3d::Zero();  ///< strictly inside, unless all is flat
  Index last_ = 0;                                      ///< where the next walk starts
};

void checkInput(const Positions& directions) {
  if (directions.cols() < 4)
    throw InvalidInput("triangulateSphere: " + std::to_string(directions.cols()) +
                       " points; at least 4 are needed");
  constexpr double tolerance = 1e-9;
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    if (!(std::abs(directions.col(i).squaredNorm() - 1.0) <= tolerance))
      throw InvalidInput("triangulateSphere: point " + std::to_string(i) +
                         " is not of unit length; normalise the points first");
}

/// The points by their places: each is given the number of its place, in any order.
std::vector<std::size_t> placesOf(const Positions& directions, std::size_t& count) {
  const auto coordinates = [&](Index i) {
    return std::tuple(directions(0, i), directions(1, i), directions(2, i));
  };
  std::vector<Index> sorted(static_cast<std::size_t>(directions.cols()));
  std::iota(sorted.begin(), sorted.end(), Index{0});
  std::sort(sorted.begin(), sorted.end(),
            [&](Index a, Index b) { return coordinates(a) < coordinates(b); });
  std::vector<std::size_t> places(sorted.size());
  count = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || coordinates(sorted[i]) != coordinates(sorted[i - 1]))
      ++count;
    places[static_cast<std::size_t>(sorted[i])] = count - 1;
  }
  return places;
}

SphereTriangulation triangulateByQhull(const Positions& directions,
                                       const internal::FractionReport& report) {
  SphereTriangulation result;
  const auto n = static_cast<std::size_t>(directions.cols());
  std::size_t place_count = 0;
  const std::vector<std::size_t> places = placesOf(directions, place_count);
  internal::reportFraction(report, 0.0);
  result.report.coincident = static_cast<Index>(n - place_count);

  std::optional<Triangles> hull;
  if (place_count >= 4)
    hull = convexHull(directions);
  internal::reportFraction(report, 0.0);
  result.report.hull_rejected = !hull.has_value();
  const Triangles start = hull ? std::move(*hull) : firstTetrahedron(directions);

  // One representative of each place is located first; the others go beside it, so that no walk has
  // to find its way among empty triangles.
  std::vector<Index> anchor(place_count, -1);
  std::vector<bool> inserted(n, false);
  for (Eigen::Index t = 0; t < start.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(start(k, t));
      inserted[vertex] = true;
      anchor[places[vertex]] = start(k, t);
    }
  const auto start_vertices =
      static_cast<Index>(std::count(inserted.begin(), inserted.end(), true));
  result.report.hull_vertices = result.report.hull_rejected ? 0 : start_vertices;
  result.report.reinserted = static_cast<Index>(n) - result.report.hull_vertices;
  if (start_vertices == static_cast<Index>(n)) {
    result.triangles = start;
    return result;
  }

  std::vector<Index> missing;
  std::vector<std::pair<Index, Index>> beside;  // point, vertex at the same place
  for (const Index p : internal::mortonOrder(directions)) {
    if (inserted[static_cast<std::size_t>(p)])
      continue;
    Index& place = anchor[places[static_cast<std::size_t>(p)]];
    if (place < 0) {
      place = p;
      missing.push_back(p);
    } else {
      beside.emplace_back(p, place);
    }
  }
  PointInserter inserter(directions, start);
  inserter.insert(missing, report);
  for (const auto& [p, vertex] : beside)
    inserter.insertAt(p, vertex);
  result.triangles = inserter.triangles();
  return result;
}

SphereTriangulation triangulateIncrementally(const Positions& directions,
                                             const internal::FractionReport& report) {
  if (directions.cols() > internal::kMaxDelaunayPoints)
    throw InvalidInput("triangulateSphere: " + std::to_string(directions.cols()) +
                       " points; TriangulationMethod::Incremental takes at most " +
                       std::to_string(internal::kMaxDelaunayPoints));
  internal::SphereDelaunay delaunay = internal::incrementalDelaunay(directions, report);
  SphereTriangulation result;
  result.triangles = std::move(delaunay.triangles);
  result.report.coincident = delaunay.coincident;
  result.report.reinserted = delaunay.coincident;
  result.report.hull_vertices = static_cast<Index>(directions.cols()) - delaunay.coincident;
  return result;
}

}  // namespace

Triangles triangulateSphere(const Positions& directions, const Execution& execution) {
  return triangulateSphere(directions, TriangulationMethod::Incremental, execution).triangles;
}

SphereTriangulation triangulateSphere(const Positions& directions, TriangulationMethod method,
                                      const Execution& execution) {
  checkInput(directions);
  const internal::FractionReport report = internal::reportOf(execution, "triangulation");
  return method == TriangulationMethod::Qhull ? triangulateByQhull(directions, report)
                                              : triangulateIncrementally(directions, report);
}

}  // namespace spherical_param
