#include "intersection_removal.h"

#include "bit_mixing.h"
#include "local_intersections.h"
#include "power_of_two.h"
#include "sphere_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_set>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Taking out a vertex frees its some six triangles and those that they intersect.
constexpr int kMostOfVertex = 12;

/// All triangulations that are tried: some 20 us each.
constexpr int kMostTriangulations = 100000;

/// A closed mesh with openings, whose changes can be undone, and what intersects in it.
class Remover {
public:
  Remover(const Positions& points, const OpenMesh& mesh)
      : points_(points), mesh_(mesh.triangles, columnCount(points)), is_open_(mesh.is_open),
        scale_(scaleToUnit(points.cwiseAbs().maxCoeff())) {
    Indexed<Face> faces;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (!isOpen(t))
        faces.push_back(face(t));
    surface_.begin(is_open_.size(), std::move(faces));
  }

  bool run(const Removal& most) {
    for (Index t = 0; t < mesh_.size(); ++t)
      if (intersects(t))
        due_.push_back(t);
    if (due_.size() > most.triangles + kMostOfVertex * most.vertices)
      return false;
    const bool is_closed = std::count(is_open_.begin(), is_open_.end(), std::uint8_t{1}) == 0;
    std::size_t next = 0;
    while (next < due_.size()) {
      const Index t = due_[next];
      const bool may_take = removal_.vertices < most.vertices;
      const bool may_leave = removal_.triangles < most.triangles;
      if (!intersects(t))
        ++next;
      else if (!retriangulate(t) && !(is_closed && may_take && takeOutNear(t, -1)) &&
               !(may_leave && leaveOut(t)) && !(may_take && takeOutNear(t, kMostOfVertex)))
        return false;
    }
    return true;
  }

  /// Leaves out what intersects, those with the most intersections first, the smaller fans where
  /// several are left at a vertex, and all pieces but the largest.
  void openAll() {
    std::vector<std::pair<int, Index>> order;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (intersects(t))
        order.emplace_back(-surface_.count(surface_.face(t), t), t);
    std::sort(order.begin(), order.end());
    for (const auto& [count, t] : order)
      if (intersects(t))
        open(t);
    leaveOneFan();
    leaveLargestPiece();
  }

  const Removal& removal() const { return removal_; }

  OpenMesh mesh() const {
    OpenMesh result;
    std::vector<Index> used;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (isUsed(t))
        used.push_back(t);
    result.triangles.resize(3, static_cast<Eigen::Index>(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i)
      for (int k = 0; k < 3; ++k)
        result.triangles(k, static_cast<Eigen::Index>(i)) = mesh_.vertex(used[i], k);
    for (const Index t : used)
      result.is_open.push_back(is_open_[t]);
    return result;
  }

private:
  bool isUsed(Index t) const { return mesh_.vertex(t, 0) >= 0; }
  bool isOpen(Index t) const { return is_open_[t] != 0; }
  Face face(Index t) const { return faceOf(points_, scale_, mesh_.vertices(t), t); }
  bool intersects(Index t) const {
    return surface_.contains(t) && surface_.intersects(surface_.face(t));
  }
  double length(Index v, Index w) const { return (points_.col(v) - points_.col(w)).norm(); }

  // --- Changes that can be undone

  void begin() {
    mesh_.journal().record();
    before_.clear();
  }
  void commit() {
    mesh_.journal().commit();
    for (const auto& [t, was_open] : before_)
      if (surface_.contains(t))
        due_.push_back(t);
  }
  void rollBack() {
    mesh_.journal().rollBack();
    for (auto change = before_.rbegin(); change != before_.rend(); ++change) {
      is_open_[change->first] = change->second;
      update(change->first);
    }
  }
  /// To be called before a triangle changes.
  void touch(Index t) { before_.emplace_back(t, is_open_[t]); }
  void update(Index t) {
    if (isUsed(t) && !isOpen(t))
      surface_.set(face(t));
    else if (surface_.contains(t))
      surface_.remove(t);
  }
  /// Takes a triangle out of the surface; returns the number of others that it intersects.
  int lift(Index t) {
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
    touch(t);
    touch(o);
    int change = -lift(t) - lift(o);
    mesh_.flipFree(t, corner);
    change += lower(t);
    change += lower(o);
    return change;
  }

  // --- 1. Other triangulations

  /// Flips that lead to a triangulation, by the ends of the sides.
  using Flips = std::vector<std::array<Index, 2>>;

  /// Takes the first triangulation of the triangles within two steps that has fewer intersections.
  bool retriangulate(Index t) {
    if (triangulations_ > kMostTriangulations)
      return false;
    // Those that help are among the first 51.
    constexpr std::size_t most_triangulations = 100;
    std::vector<Index> region{t};
    std::size_t begin_of_step = 0;
    for (int step = 0; step < 2; ++step)
      for (const std::size_t end = region.size(); begin_of_step < end; ++begin_of_step)
        for (int k = 0; k < 3; ++k) {
          const Index next = mesh_.neighbor(region[begin_of_step], k);
          if (!isOpen(next) && std::find(region.begin(), region.end(), next) == region.end())
            region.push_back(next);
        }
    std::unordered_set<std::uint64_t> seen{keyOf(region)};
    std::vector<Flips> due{{}};
    for (std::size_t i = 0; i < due.size(); ++i) {
      const Flips flips = due[i];
      for (const auto& [v, w] : sidesIn(region, flips)) {
        ++triangulations_;
        begin();
        int change = 0;
        for (const auto& [a, b] : flips)
          change += flipSide(region, a, b).value_or(0);
        const std::optional<int> last = flipSide(region, v, w);
        if (last && change + *last < 0) {
          commit();
          return true;
        }
        if (last && due.size() < most_triangulations && seen.insert(keyOf(region)).second) {
          due.push_back(flips);
          due.back().push_back({v, w});
        }
        rollBack();
      }
    }
    return false;
  }

  /// A number of a triangulation.
  std::uint64_t keyOf(const std::vector<Index>& region) const {
    std::uint64_t key = 0;
    for (const Index t : region) {
      std::array<Index, 3> corners = mesh_.vertices(t);
      std::sort(corners.begin(), corners.end());
      std::uint64_t of_triangle = 0;
      for (const Index v : corners)
        of_triangle = splitmix64(of_triangle ^ static_cast<std::uint64_t>(v));
      key += of_triangle;
    }
    return key;
  }

  /// The sides within a region after some flips.
  std::vector<std::array<Index, 2>> sidesIn(const std::vector<Index>& region, const Flips& flips) {
    begin();
    for (const auto& [a, b] : flips)
      flipSide(region, a, b);
    std::vector<std::array<Index, 2>> sides;
    for (const Index t : region)
      for (int k = 0; k < 3; ++k)
        if (const Index o = mesh_.neighbor(t, k);
            t < o && std::find(region.begin(), region.end(), o) != region.end())
          sides.push_back({mesh_.vertex(t, (k + 1) % 3), mesh_.vertex(t, (k + 2) % 3)});
    rollBack();
    return sides;
  }

  std::optional<int> flipSide(const std::vector<Index>& region, Index v, Index w) {
    for (const Index t : region)
      for (int k = 0; k < 3; ++k)
        if (mesh_.vertex(t, (k + 1) % 3) == v && mesh_.vertex(t, (k + 2) % 3) == w)
          return flip(t, k);
    return std::nullopt;
  }

  // --- 2. Triangles left out

  /// Leaves a triangle out, or one that it intersects, if the others stay a manifold; the one that
  /// intersects most first.
  bool leaveOut(Index t) {
    std::vector<Index> triangles{t};
    surface_.appendIntersecting(surface_.face(t), triangles);
    std::vector<std::pair<int, Index>> order;
    order.reserve(triangles.size());
    for (const Index u : triangles)
      order.emplace_back(-surface_.count(surface_.face(u), u), u);
    std::sort(order.begin(), order.end());
    for (const auto& [count, u] : order) {
      is_open_[u] = 1;
      const auto& corners = mesh_.vertices(u);
      if (std::all_of(corners.begin(), corners.end(), [&](Index v) { return isOneFan(v); })) {
        open(u);
        return true;
      }
      is_open_[u] = 0;
    }
    return false;
  }

  void open(Index t) {
    is_open_[t] = 1;
    surface_.remove(t);
    ++removal_.triangles;
  }

  void leaveOneFan() {
    std::vector<Index> due(columnCount(points_));
    std::iota(due.begin(), due.end(), Index{0});
    while (!due.empty()) {
      const Index v = due.back();
      due.pop_back();
      for (const std::vector<Index>& fan : smallerFans(v))
        for (const Index t : fan) {
          open(t);
          due.insert(due.end(), mesh_.vertices(t).begin(), mesh_.vertices(t).end());
        }
    }
  }

  /// The fans of the surface around a vertex, without the largest.
  std::vector<std::vector<Index>> smallerFans(Index v) const {
    std::vector<std::vector<Index>> fans;
    if (mesh_.triangleAt(v) < 0)
      return fans;
    std::vector<Index> around;
    mesh_.forEachAround(v, [&](Index t, int) { around.push_back(t); });
    const auto is_open = [&](Index t) { return isOpen(t); };
    std::rotate(around.begin(), std::find_if(around.begin(), around.end(), is_open), around.end());
    bool continues = false;
    for (const Index t : around) {
      if (!isOpen(t) && !continues)
        fans.emplace_back();
      if (!isOpen(t))
        fans.back().push_back(t);
      continues = !isOpen(t);
    }
    if (!fans.empty())
      fans.erase(std::max_element(fans.begin(), fans.end(), [](const auto& a, const auto& b) {
        return a.size() < b.size();
      }));
    return fans;
  }

  void leaveLargestPiece() {
    std::vector<Index> largest;
    IndexSet seen(is_open_.size());
    for (Index first = 0; first < mesh_.size(); ++first) {
      if (!surface_.contains(first) || !seen.insert(first))
        continue;
      std::vector<Index> piece{first};
      for (std::size_t head = 0; head < piece.size(); ++head)
        for (int k = 0; k < 3; ++k)
          if (const Index next = mesh_.neighbor(piece[head], k);
              surface_.contains(next) && seen.insert(next))
            piece.push_back(next);
      if (piece.size() > largest.size())
        largest = std::move(piece);
    }
    std::sort(largest.begin(), largest.end());
    for (Index t = 0; t < mesh_.size(); ++t)
      if (surface_.contains(t) && !std::binary_search(largest.begin(), largest.end(), t))
        open(t);
  }

  // --- 3. Vertices taken out

  /// Takes out the vertex of a triangle, or of those that it intersects, that leaves the fewest
  /// intersections. Returns whether one changes their number by at most `most`.
  bool takeOutNear(Index t, int most) {
    std::vector<Index> triangles{t};
    surface_.appendIntersecting(surface_.face(t), triangles);
    std::vector<Index> vertices;
    for (const Index u : triangles)
      vertices.insert(vertices.end(), mesh_.vertices(u).begin(), mesh_.vertices(u).end());
    sortUnique(vertices);
    Index best = -1;
    std::tuple<int, double> least{0, 0.0};
    for (const Index v : vertices) {
      begin();
      double added = 0.0;
      const std::optional<int> change = takeOut(v, added);
      if (change && *change <= most && (best < 0 || std::tuple(*change, added) < least)) {
        best = v;
        least = {*change, added};
      }
      rollBack();
    }
    if (best < 0)
      return false;
    begin();
    double added = 0.0;
    takeOut(best, added);
    commit();
    ++removal_.vertices;
    return true;
  }

  /// Flips the sides of a vertex away, and merges its last three triangles. Returns by how many
  /// pairs the number changes; nothing if that is impossible.
  ///
  /// \param added receives the length of the new sides.
  std::optional<int> takeOut(Index v, double& added) {
    std::vector<Index> ring;
    int change = 0;
    mesh_.forEachAround(v, [&](Index t, int corner) {
      ring.push_back(mesh_.vertex(t, (corner + 1) % 3));
      touch(t);
      change -= lift(t);
    });
    while (mesh_.degree(v) > 3) {
      const auto [ear, corner] = bestEar(v);
      if (ear < 0)
        return std::nullopt;
      const Index o = mesh_.neighbor(ear, corner);
      const auto at = mesh_.diamond(ear, corner);
      added += length(at.c, at.d);
      mesh_.flipFree(ear, corner);
      const auto& corners = mesh_.vertices(ear);
      change += lower(std::find(corners.begin(), corners.end(), v) == corners.end() ? ear : o);
    }
    bool is_open = false;
    mesh_.forEachAround(v, [&](Index t, int) { is_open = is_open || isOpen(t); });
    const Index merged = mesh_.merge(v);
    if (merged < 0)
      return std::nullopt;
    is_open_[merged] = is_open ? 1 : 0;
    change += lower(merged);
    return std::all_of(ring.begin(), ring.end(), [&](Index w) { return isOneFan(w); })
               ? std::optional(change)
               : std::nullopt;
  }

  /// Whether the surface around a vertex is one fan.
  bool isOneFan(Index v) const { return fansOfSurface(mesh_, is_open_, v) == 1; }

  /// The triangle and corner of the side of a vertex to flip next: fewest intersections, then the
  /// shortest new side; -1 of none.
  std::pair<Index, int> bestEar(Index v) const {
    std::pair<Index, int> best{-1, 0};
    std::tuple<int, double> least{};
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
      const std::tuple<int, double> cost{count, length(at.c, at.d)};
      if (best.first < 0 || cost < least) {
        best = {t, side};
        least = cost;
      }
    });
    return best;
  }

  const Positions& points_;
  SphereMesh mesh_;
  Indexed<std::uint8_t> is_open_;
  double scale_;                                        ///< brings the coordinates to at most 1
  LocalIntersections surface_;                          ///< its triangles
  std::vector<std::pair<Index, std::uint8_t>> before_;  ///< what has changed, and was open
  std::vector<Index> due_;                              ///< triangles that may intersect
  int triangulations_ = 0;
  Removal removal_;
};

}  // namespace

Removal leaveOutTangles(const Positions& points, OpenMesh& mesh) {
  Remover remover(points, mesh);
  remover.openAll();
  mesh = remover.mesh();
  return remover.removal();
}

std::optional<Removal> clearIntersections(const Positions& points, const Removal& most,
                                          OpenMesh& mesh) {
  Remover remover(points, mesh);
  if (!remover.run(most))
    return std::nullopt;
  mesh = remover.mesh();
  return remover.removal();
}

}  // namespace spherical_param::internal
