#include "incremental_delaunay.h"

#include "corner_table.h"
#include "exact_predicates.h"
#include "indexed.h"
#include "parallel.h"
#include "space_filling_curve.h"
#include "sphere_mesh.h"
#include "tangent_basis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Stereographic projection from a pole on the sphere: the inversion about it, which takes the
/// sphere to a plane. It uses differences from the pole, so that points near the pole are accurate
/// relative to their distance. Rounding of a direction along the radius cancels to first order.
class StereographicProjection {
public:
  /// Right-handed axes of the plane as seen from outside the sphere, looking past the antipode of
  /// the pole.
  explicit StereographicProjection(const Eigen::Vector3d& pole)
      : pole_(pole), axes_(tangentBasis(pole)) {}

  /// Finds the place of a direction in the plane, in multiples of 2^-200 below 2^200: products of
  /// four differences stay in the range of double, so predicates are exact. Returns false if the
  /// direction is too near the pole for that.
  bool project(const Eigen::Vector3d& direction, Eigen::Vector2d& place) const {
    const Eigen::Vector3d chord = direction - pole_;
    const double squared = chord.squaredNorm();
    place << snapped(chord.dot(axes_.col(1)) / squared), snapped(chord.dot(axes_.col(0)) / squared);
    constexpr double farthest = 0x1p200;
    return std::abs(place.x()) < farthest && std::abs(place.y()) < farthest;  // and not NaN
  }

private:
  /// The nearest multiple of 2^-200; doubles of 2^-148 or more are multiples already.
  static double snapped(double x) {
    constexpr double shift = 0x1.8p-148;
    return std::abs(x) < 0x1p-148 ? (x + shift) - shift : x;
  }

  Eigen::Vector3d pole_;
  TangentBasis axes_;  ///< y, x
};

/// The vertex at infinity.
constexpr Index kPole = 0;

/// Triangulation of the plane and the point at infinity.
class Triangulation {
public:
  /// \param places of all vertices in the plane; that of the pole is not used.
  /// \param start  closed, oriented, genus 0; triangle 0 without the pole, unless nothing is
  ///               inserted.
  Triangulation(const Indexed<Eigen::Vector2d>& places, const Triangles& start)
      : places_(places), mesh_(start, places.size()) {}

  Triangles triangles() const { return mesh_.triangles(); }

  /// Inserts a vertex at its place in the plane, and makes the triangulation Delaunay again.
  /// Returns the vertex that is at the same place already, if there is one, else p itself.
  Index insert(Index p) {
    const Location location = locate(p);
    if (location.coincident != kPole)
      return location.coincident;
    const std::array<Index, 3> parts = mesh_.split(location.triangle, p);
    last_ = parts[0];
    // The part at a side is flat. No other part can become flat: see inConflict().
    if (location.side >= 0)
      mesh_.flipFree(parts[static_cast<std::size_t>(location.side)], 0);
    legalize(parts[0]);
    return p;
  }

  /// Puts a vertex beside another one: it takes over half of the triangles around it.
  void putBeside(Index v, Index p) {
    const Index degree = mesh_.degree(v);
    // The neighbours at both ends get one more triangle. So the first one has the fewest of all.
    Index t = mesh_.triangleAt(v);
    const auto degree_of_end = [&](Index around) {
      return mesh_.degree(mesh_.vertex(around, previousCorner(mesh_.cornerOf(around, v))));
    };
    mesh_.forEachAround(v, [&](Index around, int) {
      if (degree_of_end(around) < degree_of_end(t))
        t = around;
    });
    const auto corner = static_cast<std::size_t>(mesh_.cornerOf(t, v));
    const Index part = mesh_.split(t, p)[(corner + 2) % 3];
    // Each flip moves one neighbour from the old vertex to the new one, which has three at first.
    // The two are never joined before.
    for (Index i = 0; i < (degree - 2) / 2; ++i)
      mesh_.flipFree(part, 0);
  }

private:
  struct Location {
    Index triangle = 0;
    int side = -1;             ///< corner opposite to the side that it is on; -1: within
    Index coincident = kPole;  ///< vertex at the same place; kPole: none
  };

  const Eigen::Vector2d& place(Index v) const { return places_[v]; }
  const Eigen::Vector2d& place(Index t, int corner) const { return place(mesh_.vertex(t, corner)); }

  /// Finds the triangle that contains a place, a closed one in the plane or one with the pole.
  /// Walks from the last inserted vertex, across any side that has the place strictly beyond it. In
  /// a Delaunay triangulation each step lowers the power of the place with respect to the circle of
  /// the triangle, or keeps it among triangles of one circle, which form a tree. So with exact
  /// predicates the walk ends (H. Edelsbrunner, 1990; O. Devillers, S. Pion and M. Teillaud,
  /// "Walking in a triangulation", 2002).
  Location locate(Index p) const {
    const Eigen::Vector2d target = place(p);
    Location location;
    Index t = last_;
    for (int k = 0; k < 3; ++k)
      if (mesh_.vertex(last_, k) == kPole)
        t = mesh_.neighbor(last_, k);
    int beyond = -1;  // the corner opposite to a side that has the place beyond it
    int entry = -1;
    do {
      if (entry >= 0 && mesh_.vertex(t, entry) == kPole)
        return {t};
      location = {t};
      beyond = -1;
      for (int k = 0; k < 3 && beyond < 0; ++k) {
        if (k == entry)
          continue;
        const int orientation =
            orientation2d(place(t, nextCorner(k)), place(t, previousCorner(k)), target);
        if (orientation < 0)
          beyond = k;
        else if (orientation == 0)
          location.side = k;
      }
      if (beyond >= 0) {
        entry = mesh_.oppositeCorner(t, beyond);
        t = mesh_.neighbor(t, beyond);
      }
    } while (beyond >= 0);
    if (location.side >= 0)
      for (const int k : {nextCorner(location.side), previousCorner(location.side)})
        if (place(t, k) == target)
          location.coincident = mesh_.vertex(t, k);
    return location;
  }

  /// Whether p, a, b (counter-clockwise) are in conflict with d beyond the side from a to b: p lies
  /// strictly inside the circle of a, b, d, or, where one of these is the pole, strictly beyond the
  /// line through the other two. (If that is d, p is never beyond.)
  bool inConflict(Index p, Index a, Index b, Index d) const {
    if (d == kPole)
      return false;
    if (a == kPole)
      return orientation2d(place(b), place(d), place(p)) < 0;
    if (b == kPole)
      return orientation2d(place(d), place(a), place(p)) < 0;
    return inCircle(place(d), place(b), place(a), place(p)) > 0;
  }

  /// Flips the sides opposite to a new vertex, corner 0 of its triangles, until none is in
  /// conflict; goes round the vertex once, counter-clockwise.
  void legalize(Index first) {
    Index t = first;
    do {
      for (;;) {
        const auto [a, b, p, d] = mesh_.diamond(t, 0);
        if (!inConflict(p, a, b, d))
          break;
        mesh_.flipFree(t, 0);
      }
      t = mesh_.neighbor(t, 1);
    } while (t != first);
  }

  const Indexed<Eigen::Vector2d>& places_;
  SphereMesh mesh_;
  Index last_ = 0;  ///< where the next walk starts
};

/// A closed mesh over at least 4 vertices of a circle, in order: a zigzag on both sides of the
/// polygon. One is shifted by a vertex, so that no two diagonals are the same.
Triangles twoSidedPolygon(const std::vector<Index>& ring) {
  Triangles triangles(3, 2 * static_cast<Eigen::Index>(ring.size()) - 4);
  Eigen::Index count = 0;
  for (const std::size_t shift : {0U, 1U}) {
    const auto vertex = [&](std::size_t i) { return ring[(i + shift) % ring.size()]; };
    std::size_t low = 0;
    std::size_t high = ring.size() - 1;
    for (bool from_low = true; high - low >= 2; from_low = !from_low) {
      const std::size_t tip = from_low ? low + 1 : high - 1;
      triangles.col(count++) << vertex(shift == 0 ? low : tip), vertex(shift == 0 ? tip : low),
          vertex(high);
      (from_low ? low : high) = tip;
    }
  }
  return triangles;
}

/// {a vertex, another one at the same place}
using Coincidence = std::array<Index, 2>;

/// Puts the vertices that coincide with others beside them, so that those at one place share its
/// triangles evenly.
void putBeside(Indexed<Coincidence> coincidences, Triangulation& triangulation) {
  std::sort(coincidences.begin(), coincidences.end());
  std::vector<Index> cluster;  // the vertices at one place
  std::size_t turn = 0;
  for (const auto& [anchor, p] : coincidences) {
    if (cluster.empty() || cluster[0] != anchor) {
      cluster.assign(1, anchor);
      turn = 0;
    }
    const Index v = cluster[turn++];
    cluster.push_back(v);
    cluster.push_back(p);
    triangulation.putBeside(v, p);
  }
}

/// The points in the order of their insertion, so that neighbours lie together in memory.
struct Vertices {
  Indexed<Index> input;             ///< the point that each vertex is; the pole is the first
  Indexed<Eigen::Vector2d> places;  ///< in the plane
  Index in_plane = 0;               ///< vertices from here on are too near the pole to have a place

  void swap(Index v, Index w) {
    std::swap(input[v], input[w]);
    std::swap(places[v], places[w]);
  }
};

Vertices projectInOrder(const Positions& directions, const FractionReport& report) {
  const auto n = static_cast<Index>(directions.cols());
  // Any point can be the pole. The highest one, nearest to the axis, does not depend on the order
  // of the points, and the axes of the plane are nearly those of space.
  const auto rank = [&](Index i) {
    const auto d = directions.col(i);
    return std::make_tuple(-d.z(), std::max(std::abs(d.x()), std::abs(d.y())), d.x(), d.y());
  };
  Index pole = 0;
  for (Index i = 1; i < n; ++i)
    if (rank(i) < rank(pole))
      pole = i;

  Vertices vertices;
  vertices.input.reserve(columnCount(directions));
  vertices.input.push_back(pole);
  vertices.places.resize(columnCount(directions));
  std::vector<Index> at_pole;
  const StereographicProjection projection(directions.col(pole));
  reportFraction(report, 0.0);
  const std::vector<Index> order = insertionOrder(directions);
  reportFraction(report, 0.0);
  for (const Index i : order) {
    if (i == pole)
      continue;
    if (projection.project(directions.col(i), vertices.places[vertices.input.count()]))
      vertices.input.push_back(i);
    else
      at_pole.push_back(i);
  }
  vertices.in_plane = vertices.input.count();
  vertices.input.insert(vertices.input.end(), at_pole.begin(), at_pole.end());
  return vertices;
}

/// Brings three vertices that are not on one line to the places 1, 2 and 3, counter-clockwise.
/// Returns false if there are none.
bool beginWithTriangle(Vertices& vertices) {
  Index second = 2;
  while (second < vertices.in_plane && vertices.places[second] == vertices.places[1])
    ++second;
  const auto orientation = [&](Index third) {
    return orientation2d(vertices.places[1], vertices.places[second], vertices.places[third]);
  };
  Index third = second + 1;
  while (third < vertices.in_plane && orientation(third) == 0)
    ++third;
  if (third >= vertices.in_plane)
    return false;
  const bool is_clockwise = orientation(third) < 0;
  vertices.swap(2, second);
  vertices.swap(3, third);
  if (is_clockwise)
    vertices.swap(2, 3);
  return true;
}

/// The vertices in their order along a line that holds all of them, the pole first: their order on
/// a circle of the sphere.
std::vector<Index> ringThroughPole(const Vertices& vertices, Indexed<Coincidence>& coincidences) {
  std::vector<Index> line(static_cast<std::size_t>(vertices.in_plane) - 1);
  std::iota(line.begin(), line.end(), Index{1});
  std::stable_sort(line.begin(), line.end(), [&](Index v, Index w) {
    const Eigen::Vector2d& a = vertices.places[v];
    const Eigen::Vector2d& b = vertices.places[w];
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Index> ring{kPole};
  for (const Index v : line)
    if (ring.back() != kPole && vertices.places[v] == vertices.places[ring.back()])
      coincidences.push_back({ring.back(), v});
    else
      ring.push_back(v);
  return ring;
}

}  // namespace

SphereDelaunay incrementalDelaunay(const Positions& directions, const FractionReport& report) {
  Vertices vertices = projectInOrder(directions, report);
  reportFraction(report, 0.0);
  Indexed<Coincidence> coincidences;
  for (Index p = vertices.in_plane; p < vertices.input.count(); ++p)
    coincidences.push_back({kPole, p});

  Triangles start(3, 4);
  start << 1, kPole, kPole, kPole,  //
      2, 3, 1, 2,                   //
      3, 2, 3, 1;
  SphereDelaunay result;
  const bool is_flat = !beginWithTriangle(vertices);
  if (is_flat) {
    std::vector<Index> ring = ringThroughPole(vertices, coincidences);
    result.coincident = coincidences.count();
    // A mesh has at least four vertices. With fewer places, some vertices join the ring beside the
    // one that they coincide with.
    for (; ring.size() < 4; coincidences.pop_back()) {
      const auto anchor = std::find(ring.begin(), ring.end(), coincidences.back()[0]);
      ring.insert(anchor + 1, coincidences.back()[1]);
    }
    start = twoSidedPolygon(ring);
  }
  Triangulation triangulation(vertices.places, start);
  if (!is_flat) {
    for (Index p = 4; p < vertices.in_plane; ++p) {
      if (static_cast<std::size_t>(p) % kReportedItems == 0)
        reportFraction(report, static_cast<double>(p) / vertices.in_plane);
      const Index v = triangulation.insert(p);
      if (v != p)
        coincidences.push_back({v, p});
    }
    result.coincident = coincidences.count();
  }
  reportFraction(report, 0.0);
  putBeside(std::move(coincidences), triangulation);
  result.triangles =
      triangulation.triangles().unaryExpr([&](Index v) { return vertices.input[v]; });
  return result;
}

}  // namespace spherical_param::internal
