#include "intersection_removal.h"

#include "bit_mixing.h"
#include "local_intersections.h"
#include "power_of_two.h"
#include "sphere_mesh.h"
#include "surface_energy.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace spherical_param::internal {
namespace {

/// By how many pairs the number of intersections may grow when a vertex is taken out.
constexpr int kMaxPairsOfVertex = 12;

/// Maximum number of exact tests of pairs of triangles, which take some 1.5 us each: fewer in an
/// open mesh, whose triangles may be left out.
std::size_t maxTests(const SphereMesh& mesh, std::size_t intersecting) {
  const std::size_t of_closed =
      std::min<std::size_t>(2000000, 100 * mesh.slotCount()) + 500 * intersecting;
  return mesh.hasOpen() ? of_closed / 5 : of_closed;
}

/// What a change costs: by how many pairs their number grows, and the length of the new sides.
using Cost = std::pair<int, double>;

/// A mesh whose changes can be undone, and what intersects in it.
class Remover {
public:
  Remover(const Positions& points, const SphereMesh& mesh, std::vector<Index> intersecting)
      : points_(points), mesh_(mesh), scale_(scaleToUnit(points.cwiseAbs().maxCoeff())),
        due_(std::move(intersecting)), max_tests_(maxTests(mesh, due_.size())) {
    Indexed<Face> faces;
    for (const Index t : mesh_.surface())
      faces.push_back(face(t));
    // Nodes that follow each other are near.
    const auto lowest = [](const Face& face) {
      return *std::min_element(face.vertices.begin(), face.vertices.end());
    };
    std::stable_sort(faces.begin(), faces.end(),
                     [&](const Face& a, const Face& b) { return lowest(a) < lowest(b); });
    surface_.begin(mesh_.slotCount(), std::move(faces));
  }

  /// \see clearIntersections
  Removal run(const Removal& most, SphereMesh& result) {
    // Small moves are cheap, and leave few triangles for large ones, unless it is a tangle.
    constexpr std::size_t max_due = 100;
    for (const std::size_t largest : {8U, 32U, 128U})
      if (largest == 8 || due_.size() <= max_due)
        clear([&](Index t) { return moveNear(t, largest); });
    result = mesh_;
    const bool is_closed = !mesh_.hasOpen();
    clear([&](Index t) {
      const bool may_take = removal_.vertices < most.vertices;
      const bool may_leave = removal_.triangles < most.triangles;
      return (is_closed && may_take && takeOutNear(t, -1)) || (may_leave && leaveOut(t)) ||
             (may_take && takeOutNear(t, kMaxPairsOfVertex));
    });
    if (!due_.empty())
      return {};
    result = std::move(mesh_);
    return removal_;
  }

private:
  /// Works on all triangles that intersect, as long as that helps; leaves the others due.
  template <typename Work>
  void clear(const Work& work) {
    std::vector<Index> stuck;
    while (!due_.empty()) {
      const Index t = due_.back();
      due_.pop_back();
      if (!intersects(t))
        continue;
      if (work(t))
        due_.push_back(t);
      else
        stuck.push_back(t);
    }
    due_ = std::move(stuck);
  }

  bool isOpen(Index t) const { return mesh_.isOpen(t); }
  Face face(Index t) const { return faceOf(points_, scale_, mesh_.vertices(t), t); }
  /// Number of triangles that intersect one, without another.
  int countOf(const Face& face, Index without) const {
    return surface_.count(face, without, std::numeric_limits<int>::max() - 1, exact_tests_);
  }
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
    const int count = countOf(surface_.face(t), t);
    surface_.remove(t);
    return count;
  }
  /// The opposite, of a triangle as it is now.
  int lower(Index t) {
    if (isOpen(t))
      return 0;
    surface_.set(face(t));
    return countOf(surface_.face(t), t);
  }

  // --- 1. Vertices moved

  /// Takes out some vertices near a triangle, and puts each back where it intersects least. Returns
  /// whether that leaves fewer intersections.
  bool moveNear(Index t, std::size_t largest) {
    for (std::size_t count = std::max<std::size_t>(2, largest / 8); count <= largest; count *= 2)
      for (int attempt = 0; attempt < 4 && exact_tests_ < max_tests_; ++attempt) {
        begin();
        if (moveAtRandom(verticesNear(t, count)) < 0) {
          commit();
          return true;
        }
        rollBack();
      }
    return false;
  }

  /// Takes vertices out, and puts them back in any order. Returns by how many pairs their number
  /// grows.
  int moveAtRandom(std::vector<Index> vertices) {
    int change = 0;
    for (const Index v : vertices) {
      const std::optional<Cost> cost = takeOut(v);
      if (!cost)
        return 0;
      change += cost->first;
    }
    for (std::size_t i = vertices.size(); i > 1; --i)
      std::swap(vertices[i - 1], vertices[random(i)]);
    std::vector<Index> places = placesFor(vertices);
    for (const Index v : vertices)
      change += putBack(v, places);
    return change + flipSmooth();
  }

  /// Flips sides of triangles that have changed, so that the surface bends less and no more
  /// triangles intersect. Returns by how many pairs their number grows.
  int flipSmooth() {
    constexpr std::size_t max_changes = 6000;
    int change = 0;
    for (std::size_t i = 0; i < changed_.size() && i < max_changes; ++i)
      for (int k = 0; k < 3; ++k)
        if (const Index t = changed_[i]; surface_.contains(t))
          change += flipIfSmoother(t, k);
    return change;
  }

  /// Flips a side if that bends the surface less, by SurfaceEnergy::Bend::Angle, and the new
  /// triangles intersect nothing. Returns by how many pairs their number grows.
  int flipIfSmoother(Index t, int corner) {
    const Index o = mesh_.neighbor(t, corner);
    const auto at = mesh_.diamond(t, corner);
    if (isOpen(o) || !isFree(mesh_, at))
      return 0;
    const auto facet = [&](Index v, Index w, Index x) {
      return RawFacet(points_.col(v), points_.col(w), points_.col(x)).facet();
    };
    const auto bend = [&](Index v, Index w, const Facet& f, const Facet& g) {
      return SurfaceEnergy().edge(v, w, points_.col(v), points_.col(w), f, g);
    };
    const auto [a, b, c, d] = at;
    const int l = mesh_.oppositeCorner(t, corner);
    // The sides of the diamond, with the triangles beyond and those on this side before and after.
    const std::array<std::array<Index, 2>, 4> sides{{{c, a}, {b, c}, {a, d}, {d, b}}};
    const std::array<Index, 4> beyond{
        mesh_.neighbor(t, (corner + 2) % 3), mesh_.neighbor(t, (corner + 1) % 3),
        mesh_.neighbor(o, (l + 1) % 3), mesh_.neighbor(o, (l + 2) % 3)};
    const Facet cab = facet(c, a, b);
    const Facet dba = facet(d, b, a);
    const Facet cad = facet(c, a, d);
    const Facet cdb = facet(c, d, b);
    double before = bend(a, b, cab, dba);
    double after = bend(c, d, cad, cdb);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& [x, y, z] = mesh_.vertices(beyond[i]);
      const Facet other = facet(x, y, z);
      before += bend(sides[i][0], sides[i][1], other, i < 2 ? cab : dba);
      after += bend(sides[i][0], sides[i][1], other, i % 2 == 0 ? cad : cdb);
    }
    constexpr double sure = 1.0 - 1e-6;
    if (!(after < sure * before))
      return 0;
    const int crossings = countOf(faceOf(points_, scale_, {c, a, d}, t), o) +
                          countOf(faceOf(points_, scale_, {c, d, b}, o), t);
    if (crossings > 0)
      return 0;
    int change = -lift(t);
    change -= lift(o);
    mesh_.flipFree(t, corner);
    change += lower(t);
    change += lower(o);
    return change;
  }

  std::size_t random(std::size_t end) { return (random_ = splitmix64(random_)) % end; }

  /// Some vertices of a triangle and of those that it intersects, at random, then of triangles
  /// around these.
  std::vector<Index> verticesNear(Index t, std::size_t count) {
    std::vector<Index> front = mesh_.verticesOf(withIntersecting(t));
    sortUnique(front);
    std::vector<Index> found;
    std::set<Index> seen(front.begin(), front.end());
    while (found.size() < count && !front.empty()) {
      const std::size_t pick = random(std::min<std::size_t>(front.size(), 12));
      const Index v = front[pick];
      front.erase(front.begin() + static_cast<std::ptrdiff_t>(pick));
      found.push_back(v);
      mesh_.forEachAround(v, [&](Index u, int corner) {
        const Index w = mesh_.vertex(u, (corner + 1) % 3);
        if (seen.insert(w).second)
          front.push_back(w);
      });
    }
    return found;
  }

  /// The triangles within the box of some vertices and of the triangles that have changed.
  std::vector<Index> placesFor(std::vector<Index> vertices) const {
    for (const Index t : changed_)
      if (mesh_.isUsed(t))
        vertices.insert(vertices.end(), mesh_.vertices(t).begin(), mesh_.vertices(t).end());
    FloatBox box;
    for (const Index v : vertices)
      box.extend((scale_ * points_.col(v)).cast<float>());
    std::vector<Index> places;
    surface_.appendWithin(box, places);
    return places;
  }

  /// Puts a vertex that was taken out into the triangle where it intersects least; of several, into
  /// the nearest one. Returns by how many pairs their number grows.
  ///
  /// \param places triangles; receives the new ones.
  int putBack(Index v, std::vector<Index>& places) {
    std::vector<std::pair<double, Index>> near;
    for (const Index t : places) {
      const auto& [a, b, c] = mesh_.vertices(t);
      near.emplace_back(length(v, a) + length(v, b) + length(v, c), t);
    }
    const auto end = near.begin() + std::min<std::ptrdiff_t>(32, near.end() - near.begin());
    std::partial_sort(near.begin(), end, near.end());
    constexpr int impossible = 1000000;
    std::pair<int, Index> best{impossible, -1};
    for (auto place = near.begin(); place != end && best.first > 0; ++place)
      best = std::min(best, {crossingsIn(place->second, v), place->second});
    if (best.second < 0)
      return impossible;
    int change = -lift(best.second);
    for (const Index part : mesh_.split(best.second, v)) {
      if (part != best.second)
        places.push_back(part);
      changed_.push_back(part);
      change += lower(part);
    }
    return change;
  }

  /// Number of intersections of a triangle that a vertex splits.
  int crossingsIn(Index t, Index v) const {
    const auto& [a, b, c] = mesh_.vertices(t);
    const std::array parts{faceOf(points_, scale_, {v, a, b}, t),
                           faceOf(points_, scale_, {v, b, c}, t),
                           faceOf(points_, scale_, {v, c, a}, t)};
    int count = 0;
    for (std::size_t i = 0; i < 3; ++i)
      count += countOf(parts[i], t) + (intersect(parts[i], parts[(i + 1) % 3]) ? 1 : 0);
    return count;
  }

  // --- 2. Triangles left out

  /// Leaves a triangle out, or one that it intersects, if the others stay a manifold; the one that
  /// intersects most first.
  bool leaveOut(Index t) {
    std::vector<std::pair<int, Index>> order;
    for (const Index u : withIntersecting(t))
      order.emplace_back(-countOf(surface_.face(u), u), u);
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
      const int count = isOpen(t) ? 0 : countOf(faceOf(points_, scale_, {at.c, w, at.d}, t), t);
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
  std::size_t max_tests_;
  mutable std::size_t exact_tests_ = 0;  ///< so far
  std::uint64_t random_ = 1;
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

Removal clearIntersections(const Positions& points, const IntersectingTriangles& pairs,
                           const Removal& most, SphereMesh& mesh) {
  std::vector<Index> triangles;
  for (const auto& pair : pairs)
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  sortUnique(triangles);
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
