#include "intersection_removal.h"

#include "local_intersections.h"
#include "power_of_two.h"
#include "sphere_mesh.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Taking out a vertex frees its some six triangles and those that they intersect.
constexpr int kMostOfVertex = 12;

/// All triangulations that are tried: some 20 us each.
constexpr int kMostTriangulations = 100000;

/// What a change costs: by how many pairs their number grows, and the length of the new sides.
using Cost = std::pair<int, double>;

/// A mesh whose changes can be undone, and what intersects in it.
class Remover {
public:
  Remover(const Positions& points, const SphereMesh& mesh, std::vector<Index> intersecting)
      : points_(points), mesh_(mesh), scale_(scaleToUnit(points.cwiseAbs().maxCoeff())),
        due_(std::move(intersecting)) {
    Indexed<Face> faces;
    for (const Index t : mesh_.surface())
      faces.push_back(face(t));
    surface_.begin(mesh_.slotCount(), std::move(faces));
  }

  /// \see clearIntersections
  std::optional<Removal> run(const Removal& most, SphereMesh& result) {
    const bool is_closed = !mesh_.hasOpen();
    for (std::size_t next = 0; next < due_.size();) {
      const Index t = due_[next];
      const bool may_take = removal_.vertices < most.vertices;
      const bool may_leave = removal_.triangles < most.triangles;
      if (!intersects(t))
        ++next;
      else if (!retriangulate(t) && !(is_closed && may_take && takeOutNear(t, -1)) &&
               !(may_leave && leaveOut(t)) && !(may_take && takeOutNear(t, kMostOfVertex)))
        return std::nullopt;
    }
    result = std::move(mesh_);
    return removal_;
  }

private:
  bool isOpen(Index t) const { return mesh_.isOpen(t); }
  Face face(Index t) const { return faceOf(points_, scale_, mesh_.vertices(t), t); }
  bool intersects(Index t) const {
    return surface_.contains(t) && surface_.intersects(surface_.face(t));
  }
  double length(Index v, Index w) const { return (points_.col(v) - points_.col(w)).norm(); }

  // --- Changes that can be undone

  void begin() {
    mesh_.journal().record();
    changed_.clear();
  }
  void commit() {
    mesh_.journal().commit();
    for (const Index t : changed_)
      if (surface_.contains(t))
        due_.push_back(t);
  }
  void rollBack() {
    mesh_.journal().rollBack();
    for (const Index t : changed_)
      update(t);
  }
  void update(Index t) {
    if (mesh_.isUsed(t) && !isOpen(t))
      surface_.set(face(t));
    else if (surface_.contains(t))
      surface_.remove(t);
  }
  /// Takes a triangle that changes out of the surface; returns the number of others that it
  /// intersects.
  int lift(Index t) {
    changed_.push_back(t);
    if (!surface_.contains(t))
      return 0;
    const int count = surface_.count(surface_.face(t), t);
    surface_.remove(t);
    return count;
  }
  /// The opposite, of a triangle as it is now.
  int lower(Index t) {
    if (isOpen(t))
      return 0;
    surface_.set(face(t));
    return surface_.count(surface_.face(t), t);
  }

  /// Flips a side, if it can be. Returns by how many pairs the number changes.
  std::optional<int> flip(Index t, int corner) {
    const Index o = mesh_.neighbor(t, corner);
    if (isOpen(t) != isOpen(o) || !isFree(mesh_, mesh_.diamond(t, corner)))
      return std::nullopt;
    int change = -lift(t);
    change -= lift(o);
    mesh_.flipFree(t, corner);
    change += lower(t);
    change += lower(o);
    return change;
  }

  // --- 1. Other triangulations

  using Side = std::array<Index, 2>;  ///< its ends

  /// A triangulation of a region.
  struct Triangulation {
    std::vector<Side> flipped;  ///< one after the other, from the first triangulation on
    std::vector<Side> sides;    ///< within the region
  };

  /// Takes the first triangulation of the triangles within two steps that has fewer intersections.
  bool retriangulate(Index t) {
    if (triangulations_ > kMostTriangulations)
      return false;
    // Those that help are among the first 51.
    constexpr std::size_t most_triangulations = 100;
    const std::vector<Index> region = regionAround(t);
    std::set<Triples> seen{trianglesOf(region)};
    std::vector<Triangulation> due{{{}, sidesIn(region)}};
    for (std::size_t i = 0; i < due.size(); ++i) {
      const Triangulation from = due[i];
      for (const Side& side : from.sides) {
        ++triangulations_;
        begin();
        int change = 0;
        for (const Side& flipped : from.flipped)
          change += flipSide(region, flipped).value_or(0);
        const std::optional<int> last = flipSide(region, side);
        if (last && change + *last < 0) {
          commit();
          return true;
        }
        if (last && due.size() < most_triangulations && seen.insert(trianglesOf(region)).second) {
          due.push_back({from.flipped, sidesIn(region)});
          due.back().flipped.push_back(side);
        }
        rollBack();
      }
    }
    return false;
  }

  /// The triangles of the surface within two steps of one.
  std::vector<Index> regionAround(Index t) const {
    std::vector<Index> region{t};
    std::size_t begin_of_step = 0;
    for (int step = 0; step < 2; ++step)
      for (const std::size_t end = region.size(); begin_of_step < end; ++begin_of_step)
        for (int k = 0; k < 3; ++k) {
          const Index next = mesh_.neighbor(region[begin_of_step], k);
          if (!isOpen(next) && std::find(region.begin(), region.end(), next) == region.end())
            region.push_back(next);
        }
    return region;
  }

  using Triples = std::vector<std::array<Index, 3>>;

  /// The corners of the triangles of a region, whatever their order.
  Triples trianglesOf(const std::vector<Index>& region) const {
    Triples triangles;
    for (const Index t : region) {
      triangles.push_back(mesh_.vertices(t));
      std::sort(triangles.back().begin(), triangles.back().end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  }

  std::vector<Side> sidesIn(const std::vector<Index>& region) const {
    std::vector<Side> sides;
    for (const Index t : region)
      for (int k = 0; k < 3; ++k)
        if (const Index o = mesh_.neighbor(t, k);
            t < o && std::find(region.begin(), region.end(), o) != region.end())
          sides.push_back(mesh_.side(t, k));
    return sides;
  }

  std::optional<int> flipSide(const std::vector<Index>& region, const Side& side) {
    for (const Index t : region)
      for (int k = 0; k < 3; ++k)
        if (mesh_.side(t, k) == side)
          return flip(t, k);
    return std::nullopt;
  }

  // --- 2. Triangles left out

  /// Leaves a triangle out, or one that it intersects, if the others stay a manifold; the one that
  /// intersects most first.
  bool leaveOut(Index t) {
    std::vector<std::pair<int, Index>> order;
    for (const Index u : withIntersecting(t))
      order.emplace_back(-surface_.count(surface_.face(u), u), u);
    std::sort(order.begin(), order.end());
    for (const auto& [count, u] : order) {
      mesh_.setOpen(u, true);
      const auto& corners = mesh_.vertices(u);
      if (std::all_of(corners.begin(), corners.end(), [&](Index v) { return isOneFan(v); })) {
        surface_.remove(u);
        ++removal_.triangles;
        return true;
      }
      mesh_.setOpen(u, false);
    }
    return false;
  }

  /// A triangle, and those that it intersects.
  std::vector<Index> withIntersecting(Index t) const {
    std::vector<Index> triangles{t};
    surface_.appendIntersecting(surface_.face(t), triangles);
    return triangles;
  }

  // --- 3. Vertices taken out

  /// Takes out the vertex of a triangle, or of those that it intersects, that leaves the fewest
  /// intersections. Returns whether one changes their number by at most `most`.
  bool takeOutNear(Index t, int most) {
    std::vector<Index> vertices = mesh_.verticesOf(withIntersecting(t));
    sortUnique(vertices);
    std::optional<std::pair<Cost, Index>> best;
    for (const Index v : vertices) {
      begin();
      const std::optional<Cost> cost = takeOut(v);
      if (cost && cost->first <= most && (!best || *cost < best->first))
        best.emplace(*cost, v);
      rollBack();
    }
    if (!best)
      return false;
    begin();
    takeOut(best->second);
    commit();
    ++removal_.vertices;
    return true;
  }

  /// Flips the sides of a vertex away, and merges its last three triangles. Returns what that
  /// costs; nothing if it is impossible.
  std::optional<Cost> takeOut(Index v) {
    Cost cost{0, 0.0};
    std::vector<Index> ring;
    mesh_.forEachAround(v, [&](Index t, int corner) {
      ring.push_back(mesh_.vertex(t, (corner + 1) % 3));
      cost.first -= lift(t);
    });
    while (mesh_.degree(v) > 3) {
      const auto [ear, corner] = bestEar(v);
      if (ear < 0)
        return std::nullopt;
      const Index o = mesh_.neighbor(ear, corner);
      const auto at = mesh_.diamond(ear, corner);
      cost.second += length(at.c, at.d);
      mesh_.flipFree(ear, corner);
      const auto& corners = mesh_.vertices(ear);
      cost.first += lower(std::find(corners.begin(), corners.end(), v) == corners.end() ? ear : o);
    }
    const Index merged = mesh_.merge(v);
    if (merged < 0)
      return std::nullopt;
    cost.first += lower(merged);
    return std::all_of(ring.begin(), ring.end(), [&](Index w) { return isOneFan(w); })
               ? std::optional(cost)
               : std::nullopt;
  }

  /// Whether the surface around a vertex is one fan.
  bool isOneFan(Index v) const { return fansAt(mesh_, v, false).size() == 1; }

  /// The triangle and corner of the side of a vertex to flip next: fewest intersections, then the
  /// shortest new side; -1 of none.
  std::pair<Index, int> bestEar(Index v) const {
    std::pair<Index, int> best{-1, 0};
    Cost least;
    mesh_.forEachAround(v, [&](Index t, int corner) {
      const int side = (corner + 1) % 3;
      const Index o = mesh_.neighbor(t, side);
      const auto at = mesh_.diamond(t, side);
      if (isOpen(t) != isOpen(o) || !isFree(mesh_, at))
        return;
      // The side leads from v to w; the ear has the two ends of the new side and w.
      const Index w = at.a == v ? at.b : at.a;
      const int count =
          isOpen(t) ? 0 : surface_.count(faceOf(points_, scale_, {at.c, w, at.d}, t), t);
      const Cost cost{count, length(at.c, at.d)};
      if (best.first < 0 || cost < least) {
        best = {t, side};
        least = cost;
      }
    });
    return best;
  }

  const Positions& points_;
  SphereMesh mesh_;
  double scale_;                ///< brings the coordinates to at most 1
  LocalIntersections surface_;  ///< its triangles
  std::vector<Index> changed_;  ///< since begin()
  std::vector<Index> due_;      ///< triangles that may intersect
  int triangulations_ = 0;
  Removal removal_;
};

/// Leaves out what intersects, those with the most intersections first.
void leaveOutIntersecting(const IntersectingTriangles& pairs, SphereMesh& mesh) {
  std::map<Index, std::vector<Index>> others;
  for (const auto& [t, u] : pairs) {
    others[t].push_back(u);
    others[u].push_back(t);
  }
  std::vector<std::pair<int, Index>> order;
  order.reserve(others.size());
  for (const auto& [t, of] : others)
    order.emplace_back(-static_cast<int>(of.size()), t);
  std::sort(order.begin(), order.end());
  for (const auto& [count, t] : order)
    for (const Index u : others[t])
      if (!mesh.isOpen(u))
        mesh.setOpen(t, true);
}

/// Leaves out the smaller fans of the surface at each vertex.
void leaveOneFan(std::size_t vertices, SphereMesh& mesh) {
  std::vector<Index> due(vertices);
  std::iota(due.begin(), due.end(), Index{0});
  while (!due.empty()) {
    const Index v = due.back();
    due.pop_back();
    if (mesh.triangleAt(v) < 0)
      continue;
    const std::vector<Fan> fans = fansAt(mesh, v, false);
    if (fans.size() < 2)
      continue;
    for (const Fan& fan : withoutLargest(fans)) {
      for (const Index t : fan)
        mesh.setOpen(t, true);
      const std::vector<Index> freed = mesh.verticesOf(fan);
      due.insert(due.end(), freed.begin(), freed.end());
    }
  }
}

/// Leaves out small pieces of the surface, but the largest.
void leaveLargePieces(std::size_t vertices, SphereMesh& mesh) {
  constexpr Index min_triangles = 50;
  const Triangles surface = mesh.surfaceTriangles();
  UnionFind pieces = piecesOf(surface, vertices);
  const Indexed<Index> sizes = sizesOf(surface, vertices, pieces);
  const Index least = std::min(min_triangles, *std::max_element(sizes.begin(), sizes.end()));
  for (const Index t : mesh.surface())
    if (sizes[pieces.find(mesh.vertex(t, 0))] < least)
      mesh.setOpen(t, true);
}

}  // namespace

std::optional<Removal> clearIntersections(const Positions& points,
                                          const IntersectingTriangles& pairs, const Removal& most,
                                          SphereMesh& mesh) {
  std::vector<Index> triangles;
  for (const auto& pair : pairs)
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  sortUnique(triangles);
  if (triangles.size() > most.triangles + kMostOfVertex * most.vertices)
    return std::nullopt;
  return Remover(points, mesh, std::move(triangles)).run(most, mesh);
}

std::size_t leaveOutTangles(std::size_t vertices, const IntersectingTriangles& pairs,
                            SphereMesh& mesh) {
  const std::size_t before = mesh.surfaceCount();
  leaveOutIntersecting(pairs, mesh);
  const std::size_t left_out = before - mesh.surfaceCount();
  leaveOneFan(vertices, mesh);
  leaveLargePieces(vertices, mesh);
  return left_out;
}

}  // namespace spherical_param::internal
