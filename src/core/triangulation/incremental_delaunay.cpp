#include "incremental_delaunay.h"

#include "exact_predicates.h"
#include "indexed.h"
#include "parallel.h"
#include "space_filling_curve.h"
#include "tangent_basis.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Stereographic projection from a pole on the sphere: inversion about it, which takes the sphere
/// to a plane. It is written in differences from the pole, which keeps what is near the pole
/// accurate in relation to its distance; and of a direction's rounding only that across the sphere
/// counts (along the radius it cancels, to first order).
class StereographicProjection {
public:
  /// Right-handed axes of the plane as seen from outside the sphere, looking past the antipode of
  /// the pole.
  explicit StereographicProjection(const Eigen::Vector3d& pole)
      : pole_(pole), axes_(tangentBasis(pole)) {}

  /// Finds the place of a direction in the plane, as doubles with which the predicates are exact:
  /// multiples of 2^-200 below 2^200, so that no product of four differences leaves the range of
  /// double. False if it is too near the pole for that.
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

/// Corner k of triangle t is written 4 t + k. It stands for the side opposite to it as well.
using Corner = std::uint32_t;

Corner cornerOf(Index triangle, unsigned k) {
  return static_cast<Corner>(triangle) << 2U | k;
}
Index triangleOf(Corner corner) {
  return static_cast<Index>(corner >> 2U);
}
unsigned next(unsigned k) {
  return k == 2 ? 0 : k + 1;
}
unsigned previous(unsigned k) {
  return k == 0 ? 2 : k - 1;
}

struct Triangle {
  std::array<Index, 3> vertices;  ///< counter-clockwise
  std::array<Corner, 3> across;   ///< opposite to corner k: the corner beyond that side
};

/// The vertex at infinity.
constexpr Index kPole = 0;

/// Triangulation of the plane and the point at infinity: a closed genus-0 mesh, changed only by
/// moves that keep it one.
class Triangulation {
public:
  /// \param places of all vertices in the plane; that of the pole is not used.
  explicit Triangulation(const std::vector<Eigen::Vector2d>& places)
      : places_(places.data()), triangles_(new Triangle[2 * places.size() - 4]) {}

  Index size() const { return size_; }
  const Triangle& triangle(Index t) const { return triangles_.get()[t]; }

  /// Starts with a closed, oriented genus-0 mesh.
  void begin(const std::vector<std::array<Index, 3>>& triangles) {
    struct Side {
      std::array<Index, 2> ends;  ///< in ascending order
      Corner corner;
      bool operator<(const Side& other) const { return ends < other.ends; }
    };
    std::vector<Side> sides;
    size_ = 0;
    for (const auto& vertices : triangles) {
      for (unsigned k = 0; k < 3; ++k) {
        const auto ends = std::minmax(vertices[next(k)], vertices[previous(k)]);
        sides.push_back({{ends.first, ends.second}, cornerOf(size_, k)});
      }
      at(size_++).vertices = vertices;
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
      across(sides[i].corner) = sides[i + 1].corner;
      across(sides[i + 1].corner) = sides[i].corner;
    }
  }

  /// Inserts a vertex at its place in the plane, and makes the triangulation Delaunay again.
  /// Returns the vertex that is at the same place already, if there is one, else p itself.
  Index insert(Index p) {
    const Location location = locate(p);
    if (location.coincident != kPole)
      return location.coincident;
    const std::array<Index, 3> parts = split(location.triangle, p);
    last_ = parts[0];
    if (location.side < 3) {
      // The part at that side is flat. No other can become flat: see inConflict().
      flip(parts[location.side]);
    }
    legalize(parts[0]);
    return p;
  }

  /// Puts a vertex beside another one that has the given corner: it takes over half of the
  /// triangles around it. Returns a triangle that has both.
  Index divide(Corner corner, Index p) {
    unsigned degree = 0;
    Corner around = corner;
    do {
      around = across(cornerOf(triangleOf(around), next(around & 3U)));
      around = cornerOf(triangleOf(around), next(around & 3U));
      ++degree;
    } while (around != corner);
    const Index t = split(triangleOf(corner), p)[previous(corner & 3U)];
    // Each flip gives one more of the neighbours from the old vertex to the new one, which has
    // three of them to begin with: they are never joined before.
    for (unsigned i = 0; i < (degree - 2) / 2; ++i)
      flip(t);
    return t;
  }

private:
  struct Location {
    Index triangle = 0;
    unsigned side = 3;         ///< corner opposite to the side that it is on; 3: within
    Index coincident = kPole;  ///< vertex at the same place; kPole: none
  };

  Triangle& at(Index t) { return triangles_.get()[t]; }
  Corner& across(Corner corner) { return at(triangleOf(corner)).across[corner & 3U]; }
  const Eigen::Vector2d& place(Index v) const { return places_[v]; }

  /// Finds the triangle that holds a place, the closed one in the plane or one with the pole, by a
  /// walk from where the last vertex went in, across any side that has the place strictly beyond
  /// it. In a Delaunay triangulation each step lowers the power of the place with respect to the
  /// circle of the triangle, or keeps it among triangles of one circle, which form a tree: with
  /// exact predicates the walk ends (H. Edelsbrunner, 1990; O. Devillers, S. Pion and M. Teillaud,
  /// "Walking in a triangulation", 2002).
  Location locate(Index p) const {
    const Eigen::Vector2d target = place(p);
    Location location;
    location.triangle = last_;
    unsigned entry = 3;
    for (unsigned k = 0; k < 3; ++k)
      if (triangle(last_).vertices[k] == kPole)
        location.triangle = triangleOf(triangle(last_).across[k]);
    for (;;) {
      const Triangle& here = triangle(location.triangle);
      location.side = 3;
      if (entry < 3 && here.vertices[entry] == kPole)
        return location;
      Corner beyond = 0;
      bool is_beyond = false;
      for (unsigned k = 0; k < 3 && !is_beyond; ++k) {
        if (k == entry)
          continue;
        const int orientation =
            orientation2d(place(here.vertices[next(k)]), place(here.vertices[previous(k)]), target);
        if (orientation < 0) {
          beyond = here.across[k];
          is_beyond = true;
        } else if (orientation == 0) {
          location.side = k;
        }
      }
      if (!is_beyond)
        break;
      location.triangle = triangleOf(beyond);
      entry = beyond & 3U;
    }
    if (location.side < 3) {
      const Triangle& here = triangle(location.triangle);
      for (const Index v :
           {here.vertices[next(location.side)], here.vertices[previous(location.side)]})
        if (place(v) == target)
          location.coincident = v;
    }
    return location;
  }

  /// Splits a triangle in three by a new vertex, which becomes corner 0 of each. Part k has the
  /// side opposite to corner k; part 0 is the triangle itself.
  std::array<Index, 3> split(Index t, Index p) {
    const Triangle old = triangle(t);
    const std::array<Index, 3> parts{t, size_, size_ + 1};
    size_ += 2;
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned k1 = next(k);
      const unsigned k2 = previous(k);
      at(parts[k]) = {{p, old.vertices[k1], old.vertices[k2]},
                      {old.across[k], cornerOf(parts[k1], 2), cornerOf(parts[k2], 1)}};
      across(old.across[k]) = cornerOf(parts[k], 0);
    }
    return parts;
  }

  /// Replaces the side opposite to corner 0 by the other diagonal of the two triangles. With (p, a,
  /// b) and d beyond, the triangle becomes (p, a, d) and the other one (p, d, b).
  void flip(Index t) {
    Triangle& near = at(t);
    const Index u = triangleOf(near.across[0]);
    const unsigned k = near.across[0] & 3U;
    Triangle& far = at(u);
    const Index d = far.vertices[k];
    const Corner beyond_ad = far.across[next(k)];
    const Corner beyond_db = far.across[previous(k)];
    const Corner beyond_bp = near.across[1];
    far.vertices = {near.vertices[0], d, near.vertices[2]};
    far.across = {beyond_db, beyond_bp, cornerOf(t, 1)};
    near.vertices[2] = d;
    near.across[0] = beyond_ad;
    near.across[1] = cornerOf(u, 2);
    across(beyond_ad) = cornerOf(t, 0);
    across(beyond_db) = cornerOf(u, 0);
    across(beyond_bp) = cornerOf(u, 1);
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

  /// Flips the sides opposite to a new vertex until none is in conflict, going round it once,
  /// counter-clockwise from one of its triangles.
  void legalize(Index first) {
    Index t = first;
    do {
      for (;;) {
        const Triangle& here = triangle(t);
        const Corner beyond = here.across[0];
        const Index d = triangle(triangleOf(beyond)).vertices[beyond & 3U];
        if (!inConflict(here.vertices[0], here.vertices[1], here.vertices[2], d))
          break;
        flip(t);
      }
      t = triangleOf(triangle(t).across[1]);
    } while (t != first);
  }

  const Eigen::Vector2d* places_;
  std::unique_ptr<Triangle[]> triangles_;  ///< not a vector, which would write it all first
  Index size_ = 0;
  Index last_ = 0;  ///< where the next walk starts
};

/// Vertices of one circle, in order, as a closed mesh: both sides of the polygon in zigzag, one
/// of them a vertex further, so that no two diagonals are the same. At least 4 vertices.
std::vector<std::array<Index, 3>> twoSidedPolygon(const std::vector<Index>& ring) {
  std::vector<std::array<Index, 3>> triangles;
  for (const std::size_t shift : {0U, 1U}) {
    const auto vertex = [&](std::size_t i) { return ring[(i + shift) % ring.size()]; };
    std::size_t low = 0;
    std::size_t high = ring.size() - 1;
    for (bool from_low = true; high - low >= 2; from_low = !from_low) {
      const std::size_t tip = from_low ? low + 1 : high - 1;
      triangles.push_back({vertex(low), vertex(tip), vertex(high)});
      (from_low ? low : high) = tip;
      if (shift == 1)
        std::swap(triangles.back()[0], triangles.back()[1]);
    }
  }
  return triangles;
}

/// {a vertex, another one that coincides with it}
using Coincidence = std::array<Index, 2>;

/// Puts the vertices that coincide with others beside them, so that those at one place share its
/// triangles evenly.
void putBeside(Indexed<Coincidence> coincidences, Index vertex_count,
               Triangulation& triangulation) {
  if (coincidences.empty())
    return;
  std::sort(coincidences.begin(), coincidences.end());
  Indexed<Index> triangle_at(static_cast<std::size_t>(vertex_count), -1);
  for (Index t = 0; t < triangulation.size(); ++t)
    for (const Index v : triangulation.triangle(t).vertices)
      triangle_at[v] = t;
  std::vector<Index> crowd;  // the vertices at one place
  std::size_t turn = 0;
  for (const auto& [anchor, p] : coincidences) {
    if (crowd.empty() || crowd[0] != anchor) {
      crowd.assign(1, anchor);
      turn = 0;
    }
    const Index v = crowd[turn++];
    crowd.push_back(v);
    crowd.push_back(p);
    const Index t = triangle_at[v];
    const auto& vertices = triangulation.triangle(t).vertices;
    const auto k = std::find(vertices.begin(), vertices.end(), v) - vertices.begin();
    const Index first = triangulation.divide(cornerOf(t, static_cast<unsigned>(k)), p);
    // Every triangle that has changed is now around p.
    Index around = first;
    do {
      for (const Index w : triangulation.triangle(around).vertices)
        triangle_at[w] = around;
      around = triangleOf(triangulation.triangle(around).across[1]);
    } while (around != first);
  }
}

/// The points, numbered in the order in which they go in: neighbours lie together in memory.
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
  // Any point would do as pole. The highest one, nearest to the axis, makes the axes of the plane
  // nearly those of space, and does not depend on the order of the points.
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
/// False if there are none.
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

/// Vertices that are all on one line, in its order, the pole first: on the sphere, their order on a
/// circle through the pole.
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
  const Index n = vertices.input.count();
  Indexed<Coincidence> coincidences;
  for (Index p = vertices.in_plane; p < n; ++p)
    coincidences.push_back({kPole, p});

  Triangulation triangulation(vertices.places);
  SphereDelaunay result;
  if (beginWithTriangle(vertices)) {
    triangulation.begin({{1, 2, 3}, {kPole, 3, 2}, {kPole, 1, 3}, {kPole, 2, 1}});
    for (Index p = 4; p < vertices.in_plane; ++p) {
      if (static_cast<std::size_t>(p) % kReportedItems == 0)
        reportFraction(report, static_cast<double>(p) / vertices.in_plane);
      const Index v = triangulation.insert(p);
      if (v != p)
        coincidences.push_back({v, p});
    }
    result.coincident = coincidences.count();
  } else {
    std::vector<Index> ring = ringThroughPole(vertices, coincidences);
    result.coincident = coincidences.count();
    // A mesh has at least four vertices: at three places or fewer, some begin beside their anchor.
    for (; ring.size() < 4; coincidences.pop_back()) {
      const auto anchor = std::find(ring.begin(), ring.end(), coincidences.back()[0]);
      ring.insert(anchor + 1, coincidences.back()[1]);
    }
    triangulation.begin(twoSidedPolygon(ring));
  }
  reportFraction(report, 0.0);
  putBeside(std::move(coincidences), n, triangulation);

  result.triangles.resize(3, triangulation.size());
  for (Index t = 0; t < triangulation.size(); ++t) {
    const auto& [a, b, c] = triangulation.triangle(t).vertices;
    result.triangles.col(t) << vertices.input[a], vertices.input[b], vertices.input[c];
  }
  return result;
}

}  // namespace spherical_param::internal
