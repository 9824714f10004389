#include "open_mesh.h"

#include "indexed.h"
#include "local_intersections.h"
#include "power_of_two.h"
#include "sphere_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Where a vertex without triangles of the surface may get some: an edge of the boundary, or a
/// triangle of the surface.
struct Place {
  double distance;  ///< sum over its corners
  Index triangle;   ///< the open one at the edge, or that of the surface
  int corner;       ///< opposite to the edge; -1: the triangle
};

/// Leaves the 64 nearest places.
void keepNearest(std::vector<Place>& places) {
  const auto end = places.begin() + std::min<std::ptrdiff_t>(64, places.end() - places.begin());
  std::partial_sort(places.begin(), end, places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.distance, a.triangle, a.corner) < std::tie(b.distance, b.triangle, b.corner);
  });
  places.erase(end, places.end());
}

/// The first of the candidates that crosses nothing, or the one that crosses least; nullptr of
/// none.
///
/// \param crossings (candidate, most): the number; counting may stop beyond `most`.
/// \param least what it crosses.
template <typename Candidate, typename Crossings>
const Candidate* leastCrossing(const std::vector<Candidate>& candidates, const Crossings& crossings,
                               int& least) {
  const Candidate* best = nullptr;
  least = std::numeric_limits<int>::max();
  for (const Candidate& candidate : candidates)
    if (const int count = crossings(candidate, least - 1); count < least) {
      best = &candidate;
      least = count;
      if (count == 0)
        break;
    }
  return best;
}

class Opener {
public:
  Opener(const Positions& points, const OpenPlaces& openings, SphereMesh& mesh)
      : points_(points), mesh_(mesh), scale_(scaleToUnit(points.cwiseAbs().maxCoeff())) {
    for (Index t = 0; t < mesh_.size(); ++t)
      mesh_.setOpen(t, openings.isOpen(mesh_.vertices(t)));
    for (const Index t : trianglesWithoutLoop(mesh_, openings))
      mesh_.setOpen(t, false);
  }

  void run() {
    Indexed<Face> faces;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (!isOpen(t))
        faces.push_back(face(t, mesh_.vertices(t)));
    surface_.begin(mesh_.slotCount(), std::move(faces));
    for (const Index v : verticesOfOpen())
      if (fanCount(v) == 0)
        attach(v);
    std::vector<Index> due = verticesOfOpen();
    while (!due.empty()) {
      const Index v = due.back();
      due.pop_back();
      // Several fans may be left at this vertex, and new ones at the vertices of the gap.
      if (fanCount(v) > 1)
        for (const Index w : release(v))
          due.push_back(w);
    }
  }

private:
  bool isOpen(Index t) const { return mesh_.isOpen(t); }

  double length(Index v, Index w) const { return (points_.col(v) - points_.col(w)).norm(); }

  /// Ascending.
  std::vector<Index> verticesOfOpen() const {
    std::vector<Index> vertices;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (isOpen(t))
        vertices.insert(vertices.end(), mesh_.vertices(t).begin(), mesh_.vertices(t).end());
    sortUnique(vertices);
    return vertices;
  }

  /// Number of fans of the surface at a vertex.
  std::size_t fanCount(Index v) const { return fansAt(mesh_, v, false).size(); }

  /// Joins a vertex by one triangle to an edge of the boundary, or puts it into a triangle of the
  /// surface: at the nearest place where that intersects nothing, edges first.
  void attach(Index v) {
    std::vector<Place> edges;
    for (Index t = 0; t < mesh_.size(); ++t)
      for (int k = 0; isOpen(t) && k < 3; ++k)
        if (!isOpen(mesh_.neighbor(t, k))) {
          const auto [a, b] = mesh_.side(t, k);
          edges.push_back({length(v, a) + length(v, b), t, k});
        }
    keepNearest(edges);
    int least = 0;
    const Place* edge = leastCrossing(
        edges, [&](const Place& place, int most) { return crossingsAt(v, place, most); }, least);
    if (edge == nullptr) {
      close(smallestAt(v));
      return;
    }
    const auto [a, b] = mesh_.side(edge->triangle, edge->corner);
    const std::optional<Index> cover = least > 0 ? coverOf(v) : std::nullopt;
    if (!takeOut(v))
      close(smallestAt(v));
    else if (!cover)
      close(besideEdge(v, a, b));
    else
      for (const Index part : mesh_.split(*cover, v))
        close(part);
  }

  /// The nearest triangle of the surface that a vertex may split without intersections.
  std::optional<Index> coverOf(Index v) const {
    std::vector<Place> covers;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (!isOpen(t)) {
        const auto& [a, b, c] = mesh_.vertices(t);
        covers.push_back({length(v, a) + length(v, b) + length(v, c), t, -1});
      }
    keepNearest(covers);
    for (const Place& place : covers)
      if (crossingsAt(v, place, 0) == 0)
        return place.triangle;
    return std::nullopt;
  }

  /// Number of triangles of the surface that those of a vertex would intersect at a place; counting
  /// may stop beyond `most`.
  int crossingsAt(Index v, const Place& place, int most) const {
    const auto corner = [&](int k) { return mesh_.vertex(place.triangle, k % 3); };
    const auto with_side = [&](int k) {
      return crossings({corner(k + 1), corner(k + 2), v}, place.triangle, most);
    };
    return place.corner >= 0 ? with_side(place.corner) : with_side(0) + with_side(1) + with_side(2);
  }

  /// Takes a vertex out of the mesh, if its triangles are open.
  bool takeOut(Index v) {
    const auto flips_edge_away = [&](Index t, int corner) {
      return mesh_.flip(t, (corner + 1) % 3);
    };
    while (mesh_.degree(v) > 3 && mesh_.anyAround(v, flips_edge_away)) {
    }
    return mesh_.degree(v) == 3 && mesh_.merge(v) >= 0;
  }

  /// Puts a vertex that was taken out into the open triangle to the left of an edge. Returns the
  /// triangle of both.
  Index besideEdge(Index v, Index a, Index b) {
    const auto at_edge = [&] {
      Index found = -1;
      mesh_.anyAround(a, [&](Index t, int corner) {
        found = t;
        return mesh_.vertex(t, (corner + 1) % 3) == b;
      });
      return found;
    };
    for (const Index t : mesh_.split(at_edge(), v))
      open(t);
    return at_edge();
  }

  Index smallestAt(Index v) const {
    const Fan around = trianglesAround(mesh_, v);
    return *std::min_element(around.begin(), around.end(),
                             [&](Index t, Index u) { return perimeter(t) < perimeter(u); });
  }

  /// Joins two fans at a vertex: closes the narrowest gap where that intersects nothing. Returns
  /// the vertices of the gap.
  std::vector<Index> release(Index v) {
    std::vector<Fan> gaps = fansAt(mesh_, v, true);
    std::stable_sort(gaps.begin(), gaps.end(),
                     [&](const Fan& a, const Fan& b) { return widthAt(v, a) < widthAt(v, b); });
    for (Fan& gap : gaps)
      trim(v, gap);
    int least = 0;
    const auto count_crossings = [&](const Fan& run, int most) {
      int count = 0;
      for (const Index t : run)
        count += crossings(mesh_.vertices(t), t, most - count);
      return count;
    };
    const Fan* gap = leastCrossing(gaps, count_crossings, least);
    for (const Index t : *gap)
      close(t);
    return mesh_.verticesOf(*gap);
  }

  /// Number of triangles of the surface, except `without`, that a new one would intersect; counting
  /// may stop beyond `most`.
  int crossings(const std::array<Index, 3>& corners, Index without, int most) const {
    return surface_.count(face(-1, corners), without, most);
  }

  Face face(Index t, const std::array<Index, 3>& corners) const {
    return faceOf(points_, scale_, corners, t);
  }

  /// Distance of the first and the last neighbour of a run.
  double widthAt(Index v, const Fan& run) const {
    return length(mesh_.vertex(run.front(), (mesh_.cornerOf(run.front(), v) + 1) % 3),
                  mesh_.vertex(run.back(), (mesh_.cornerOf(run.back(), v) + 2) % 3));
  }

  double perimeter(Index t) const {
    const auto& [a, b, c] = mesh_.vertices(t);
    return length(a, b) + length(b, c) + length(c, a);
  }

  /// Flips edges of a vertex within a run of its triangles away, as far as possible. Leaves the
  /// triangles that stay at the vertex in the run.
  void trim(Index v, Fan& run) {
    for (auto t = run.begin(); t + 1 < run.end();)
      // The edge to the next triangle is opposite to the corner after v.
      if (!mesh_.flip(*t, (mesh_.cornerOf(*t, v) + 1) % 3)) {
        ++t;
      } else {
        run.erase(t);  // has left the vertex
        t = run.begin();
      }
  }

  void open(Index t) {
    mesh_.setOpen(t, true);
    if (surface_.contains(t))
      surface_.remove(t);
  }
  void close(Index t) {
    mesh_.setOpen(t, false);
    surface_.set(face(t, mesh_.vertices(t)));
  }

  const Positions& points_;
  SphereMesh& mesh_;
  double scale_;                ///< brings the coordinates to at most 1
  LocalIntersections surface_;  ///< its triangles
};

}  // namespace

void openMesh(const Positions& points, const OpenPlaces& openings, SphereMesh& mesh) {
  Opener(points, openings, mesh).run();
}

}  // namespace spherical_param::internal
