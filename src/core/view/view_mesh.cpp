#include "view_mesh.h"

#include "energy_mesh.h"
#include "exact_predicates.h"
#include "flips.h"
#include "incremental_delaunay.h"
#include "indexed.h"
#include "sphere_mesh.h"
#include "tangent_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace spherical_param::internal {
namespace {

/// The points and the vertex behind the place.
Positions withBehind(const Positions& points, const ViewMesh& view) {
  if (view.behind < 0)
    return points;
  Positions all(3, points.cols() + 1);
  all.leftCols(points.cols()) = points;
  const Positions directions = directionsFrom(view.place, points);
  all.col(view.behind) = view.place - directions.rowwise().mean().normalized();
  return all;
}

/// Orientations as a place sees them.
class Signs {
public:
  Signs(const Eigen::Vector3d& place, const Positions& points) : place_(place), points_(points) {}

  /// 1 if three vertices are counter-clockwise as in an outward triangle, 0 in a plane with the
  /// place.
  int sign(Index a, Index b, Index c) const {
    return orientation3d(place_, points_.col(a), points_.col(b), points_.col(c));
  }
  bool isOutward(const std::array<Index, 3>& t) const { return sign(t[0], t[1], t[2]) > 0; }
  bool mayFlip(const SphereMesh::Diamond& at) const {
    return at.c != at.d && sign(at.c, at.a, at.d) > 0 && sign(at.c, at.d, at.b) > 0;
  }

private:
  const Eigen::Vector3d& place_;
  const Positions& points_;
};

/// Makes all triangles outward, in exact arithmetic: rounding of the directions may have turned
/// some.
class Repair {
public:
  Repair(const Signs& signs, SphereMesh& mesh, Index behind)
      : signs_(signs), mesh_(mesh), behind_(behind) {}

  /// Flips sides of triangles that are not outward, and takes points out where that does not help.
  ///
  /// \param hidden receives these points, ascending.
  /// \return whether all triangles are outward.
  bool run(std::vector<Index>& hidden) {
    constexpr int max_rounds = 30;
    // Rounding turns fewer triangles than this fraction.
    constexpr double max_inward = 0.1;
    std::vector<Index> inward = inwardTriangles();
    if (inward.size() > fractionOf(max_inward, mesh_.slotCount()) + 1)
      return false;
    for (int round = 0; round < max_rounds && !inward.empty(); ++round) {
      for (const Index t : inward)
        if (isInward(t))
          flipSide(t);
      for (const Index t : inward)
        if (isInward(t))
          takeOutOneOf(t, hidden);
      inward = inwardTriangles();
    }
    std::sort(hidden.begin(), hidden.end());
    return inward.empty();
  }

private:
  std::vector<Index> inwardTriangles() const {
    std::vector<Index> inward;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (isInward(t))
        inward.push_back(t);
    return inward;
  }

  bool isInward(Index t) const { return mesh_.isUsed(t) && !signs_.isOutward(mesh_.vertices(t)); }

  void flipSide(Index t) {
    for (int k = 0; k < 3; ++k)
      if (signs_.mayFlip(mesh_.diamond(t, k)) && mesh_.flip(t, k))
        return;
  }

  void takeOutOneOf(Index t, std::vector<Index>& hidden) {
    const std::array<Index, 3> corners = mesh_.vertices(t);
    for (const Index v : corners)
      if (v != behind_ && takeOut(v)) {
        hidden.push_back(v);
        return;
      }
  }

  /// Takes a vertex out: flips its edges away, unless that would turn triangles over.
  bool takeOut(Index v) {
    const auto flips_away = [&](Index t, int corner) {
      const int k = (corner + 1) % 3;
      const auto [a, b, c, d] = mesh_.diamond(t, k);
      // The flip makes two triangles (c, a, d) and (c, d, b). The one without v must be outward.
      const bool is_cut = a == v ? signs_.sign(c, d, b) > 0 && signs_.sign(c, a, d) >= 0
                                 : signs_.sign(c, a, d) > 0 && signs_.sign(c, d, b) >= 0;
      return is_cut && mesh_.flip(t, k);
    };
    while (mesh_.degree(v) > 3)
      if (!mesh_.anyAround(v, flips_away))
        return false;
    return mesh_.merge(v) >= 0;
  }

  const Signs& signs_;
  SphereMesh& mesh_;
  Index behind_;
};

/// Whether the triangles are once around the place: only one of them is over the direction of its
/// middle.
bool areOnceAround(const Signs& signs, Positions& points, const SphereMesh& mesh) {
  const Triangles triangles = mesh.triangles();
  // The middle of the first triangle, as one more point.
  const auto middle = static_cast<Index>(points.cols());
  points.conservativeResize(3, middle + 1);
  points.col(middle) =
      (points.col(triangles(0, 0)) + points.col(triangles(1, 0)) + points.col(triangles(2, 0))) /
      3.0;
  const auto is_over = [&](const auto& t) {
    return signs.sign(t[0], t[1], middle) >= 0 && signs.sign(t[1], t[2], middle) >= 0 &&
           signs.sign(t[2], t[0], middle) >= 0;
  };
  const auto over = std::count_if(triangles.colwise().begin(), triangles.colwise().end(), is_over);
  points.conservativeResize(3, middle);
  return over == 1;
}

/// The mesh from exactly a place; without triangles if there is none.
ViewMesh triangulateFrom(const Eigen::Vector3d& place, const Positions& points, bool has_behind,
                         const FractionReport& report) {
  ViewMesh view;
  view.place = place;
  view.behind = has_behind ? static_cast<Index>(points.cols()) : -1;
  Positions all = withBehind(points, view);
  SphereMesh mesh(incrementalDelaunay(directionsFrom(place, all), report).triangles,
                  columnCount(all));
  const Signs signs(place, all);
  if (Repair(signs, mesh, view.behind).run(view.hidden) && areOnceAround(signs, all, mesh))
    view.triangles = mesh.triangles();
  return view;
}

/// The same; a vertex behind the place closes the mesh if all points are in front of it.
ViewMesh triangulateAround(const Eigen::Vector3d& place, const Positions& points,
                           const FractionReport& report) {
  const Positions directions = directionsFrom(place, points);
  const Eigen::Vector3d mean = directions.rowwise().mean();
  if ((mean.transpose() * directions).minCoeff() > 0.0)
    return triangulateFrom(place, points, true, report);
  // The mean direction may be off: then all points may be in front of the place nevertheless.
  ViewMesh view = triangulateFrom(place, points, false, report);
  return view.triangles.cols() > 0 ? view : triangulateFrom(place, points, true, report);
}

}  // namespace

Positions directionsFrom(const Eigen::Vector3d& place, const Positions& points) {
  Positions directions = points.colwise() - place;
  for (auto direction : directions.colwise()) {
    const double length = direction.stableNorm();
    if (length > 0.0 && std::isfinite(length))
      direction /= length;
    else
      direction = Eigen::Vector3d::UnitZ();
  }
  return directions;
}

ViewMesh triangulateView(const Positions& points, const Eigen::Vector3d& place,
                         const FractionReport& report) {
  // From farther away, rounding makes all directions equal.
  constexpr double max_distance = 0x1p40;
  if (!(place.cwiseAbs().maxCoeff() < max_distance * (1.0 + points.cwiseAbs().maxCoeff())))
    return {};
  // So small that depth jumps hardly look different [distance of the points].
  constexpr std::array<double, 3> moves = {0.001, 0.004, 0.016};
  constexpr double max_hidden = 0.0005;
  ViewMesh best = triangulateAround(place, points, report);
  const double distance = (points.colwise() - place).colwise().norm().mean();
  const TangentBasis across = tangentBasis((points.rowwise().mean() - place).stableNormalized());
  for (const double move : moves) {
    if (best.triangles.cols() > 0 &&
        best.hidden.size() <= fractionOf(max_hidden, columnCount(points)))
      break;
    ViewMesh moved = triangulateAround(
        place + move * distance * (0.6 * across.col(0) + 0.8 * across.col(1)), points, report);
    if (moved.triangles.cols() > 0 &&
        (best.triangles.cols() == 0 || moved.hidden.size() < best.hidden.size()))
      best = std::move(moved);
  }
  return best;
}

void flipInView(const Positions& points, ViewMesh& view, const Execution& execution,
                const std::function<bool()>& ends) {
  const Positions all = withBehind(points, view);
  Graph graph;  // gives the energy its unit of length
  std::vector<double> lengths;
  for (const auto& t : view.triangles.colwise())
    lengths.push_back((all.col(t[0]) - all.col(t[1])).norm());
  graph.lengths.push_back(medianOf(lengths));
  EnergyMesh mesh(all, SphereMesh(view.triangles, columnCount(all), execution.threads), graph,
                  execution.threads);
  const Signs signs(view.place, all);
  mesh.setFlipRule([&](const SphereMesh::Diamond& at) {
    const auto is_behind = [&](Index v) { return v == view.behind; };
    return !is_behind(at.a) && !is_behind(at.b) && !is_behind(at.c) && !is_behind(at.d) &&
           signs.mayFlip(at);
  });
  Flips(mesh).flipAll(reportOf(execution, "optimization"), ends);
  view.triangles = mesh.mesh().triangles();
}

}  // namespace spherical_param::internal
