#include "glue.h"

#include "indexed.h"
#include "sphere_mesh.h"
#include "spherical_param/mesh_topology.h"
#include "union_find.h"

#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The rims of a cut graph.
struct Rims {
  explicit Rims(const CutGraph& cut)
      : nodes(static_cast<Index>(cut.graph.size())), node_of(cut.node_of),
        next(cut.graph.size(), -1), twin(cut.graph.size(), -1) {
    for (const std::vector<Index>& rim : cut.rims) {
      Index from = rim.back();
      for (const Index to : rim)
        next[std::exchange(from, to)] = to;
    }
    for (Index v = 0; v < nodes; ++v)
      if (node_of[v] != v) {
        twin[v] = node_of[v];
        twin[node_of[v]] = v;
      }
  }

  bool isVirtual(Index v) const { return v >= nodes; }
  bool isOn(Index v) const { return v < nodes && next[v] >= 0; }
  /// Whether an edge is in a rim.
  bool isEdge(Index v, Index w) const {
    return v < nodes && w < nodes && (next[v] == w || next[w] == v);
  }

  Index nodes;
  const Indexed<Index>& node_of;
  Indexed<Index> next;  ///< along the rim, the surface on the left; -1: not on a rim
  Indexed<Index> twin;  ///< the other copy; -1
};

/// Turns the spheres most of whose virtual nodes are on the left of their rims.
void turn(const Rims& rims, Index vertices, Triangles& spheres) {
  const auto count = static_cast<std::size_t>(vertices);
  UnionFind sets = piecesOf(spheres, count);
  Indexed<Index> votes(count, 0);
  for (const auto& t : spheres.colwise())
    for (Index k = 0; k < 3; ++k) {
      const Index v = t[k];
      const Index w = t[(k + 1) % 3];
      if (rims.isEdge(v, w) && rims.isVirtual(t[(k + 2) % 3]))
        votes[sets.find(v)] += rims.next[v] == w ? 1 : -1;
    }
  for (auto t : spheres.colwise())
    if (votes[sets.find(t[0])] > 0)
      std::swap(t[1], t[2]);
}

class Gluer {
public:
  Gluer(const CutGraph& cut, const Rims& rims, const Triangles& spheres, Index vertices)
      : cut_(cut), rims_(rims), vertices_(vertices),
        mesh_(spheres, static_cast<std::size_t>(vertices)), came_from_(mesh_.slotCount()),
        seen_(mesh_.slotCount()) {}

  /// Makes the spheres ready to be glued. Returns whether that succeeded.
  bool prepare() {
    return forEachRimEdge([&](Index v, Index w) { return recover(v, w); }) && emptyRims() &&
           flipDoubles();
  }

  /// The triangles outside of the rims, by the nodes before the cut.
  Triangles glued() const {
    const Indexed<char> inside = insides();
    std::vector<Index> corners;
    for (Index t = 0; t < mesh_.size(); ++t)
      if (mesh_.vertex(t, 0) >= 0 && inside[t] == 0)
        for (const Index v : mesh_.vertices(t))
          corners.push_back(rims_.node_of[v]);
    return Eigen::Map<const Triangles>(corners.data(), 3,
                                       static_cast<Eigen::Index>(corners.size() / 3));
  }

private:
  template <typename Visit>
  bool forEachRimEdge(const Visit& visit) const {
    for (const std::vector<Index>& rim : cut_.rims)
      for (const Index v : rim)
        if (!visit(v, rims_.next[v]))
          return false;
    return true;
  }

  /// Makes an edge by flips, without losing any of the rims'.
  bool recover(Index a, Index b) {
    // Each flip makes the strip a triangle shorter, unless the edge that it would make is there
    // already.
    constexpr int max_flips = 1000;
    for (int flips = 0; flips < max_flips && !mesh_.areJoined(a, b); ++flips) {
      const Index t = shortestStrip(a, b);
      if (t < 0 || (!mesh_.flip(t, mesh_.cornerOf(t, a)) && !flipInStrip(came_from_[t])))
        return false;
    }
    return mesh_.areJoined(a, b);
  }

  /// Flips an edge within a strip. Returns whether there was one that can be.
  bool flipInStrip(Index t) {
    for (; came_from_[t] >= 0; t = came_from_[t])
      for (int k = 0; k < 3; ++k)
        if (mesh_.neighbor(t, k) == came_from_[t] && mesh_.flip(t, k))
          return true;
    return false;
  }

  /// Finds the shortest way across edges that are not of rims, from triangles at b. Returns its
  /// triangle at a; came_from_ leads on. -1: none.
  Index shortestStrip(Index a, Index b) {
    seen_.clear();
    std::vector<Index> queue;
    mesh_.forEachAround(b, [&](Index t, int) {
      seen_.insert(t);
      came_from_[t] = -1;
      queue.push_back(t);
    });
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const Index t = queue[i];
      for (int k = 0; k < 3; ++k) {
        const Index v = mesh_.vertex(t, (k + 1) % 3);
        const Index w = mesh_.vertex(t, (k + 2) % 3);
        // Not across an edge at b: that only leads around it.
        if (rims_.isEdge(v, w) || v == b || w == b)
          continue;
        const Index u = mesh_.neighbor(t, k);
        if (!seen_.insert(u))
          continue;
        came_from_[u] = t;
        if (mesh_.vertex(u, mesh_.cornerOf(u, a)) == a)
          return u;
        queue.push_back(u);
      }
    }
    return -1;
  }

  /// For each triangle, 1 inside of the rims.
  Indexed<char> insides() const {
    Indexed<char> inside(mesh_.slotCount(), 0);
    std::vector<Index> queue;
    const auto add = [&](Index t) {
      if (std::exchange(inside[t], 1) == 0)
        queue.push_back(t);
    };
    forEachRimEdge([&](Index v, Index w) {
      mesh_.anyAround(w, [&](Index t, int corner) {
        const bool is_right = mesh_.vertex(t, (corner + 1) % 3) == v;
        if (is_right)
          add(t);
        return is_right;
      });
      return true;
    });
    while (!queue.empty()) {
      const Index t = queue.back();
      queue.pop_back();
      for (int k = 0; k < 3; ++k)
        if (!rims_.isEdge(mesh_.vertex(t, (k + 1) % 3), mesh_.vertex(t, (k + 2) % 3)))
          add(mesh_.neighbor(t, k));
    }
    return inside;
  }

  /// Moves nodes out of the rims, and drops virtual ones outside of them.
  bool emptyRims() {
    const Indexed<char> inside = insides();
    std::vector<Index> lost;
    for (Index v = 0; v < vertices_; ++v) {
      if (mesh_.triangleAt(v) < 0 || rims_.isOn(v) ||
          rims_.isVirtual(v) == (inside[mesh_.triangleAt(v)] != 0))
        continue;
      if (!takeOut(v))
        return false;
      if (!rims_.isVirtual(v))
        lost.push_back(v);
    }
    // Each beside a neighbour that is outside.
    while (!lost.empty()) {
      const Indexed<char> now = insides();
      std::vector<Index> rest;
      for (const Index v : lost)
        if (!putBack(v, now))
          rest.push_back(v);
      if (rest.size() == lost.size())
        return false;
      lost = std::move(rest);
    }
    return true;
  }

  bool takeOut(Index v) {
    const auto flips_away = [&](Index t, int corner) { return mesh_.flip(t, (corner + 1) % 3); };
    while (mesh_.degree(v) > 3 && mesh_.anyAround(v, flips_away)) {
    }
    return mesh_.degree(v) == 3 && mesh_.merge(v) >= 0;
  }

  /// \param inside triangles, before others were put back.
  bool putBack(Index v, const Indexed<char>& inside) {
    const auto splits_outside = [&](Index t, int) {
      if (inside[t] == 0)
        mesh_.split(t, v);
      return inside[t] == 0;
    };
    for (const Index w : cut_.graph.row(v))
      if (mesh_.triangleAt(w) >= 0 && mesh_.anyAround(w, splits_outside))
        return true;
    return false;
  }

  /// Flips away edges that are doubled by the gluing.
  bool flipDoubles() {
    return forEachRimEdge([&](Index v, Index) {
      while (mesh_.anyAround(
          v, [&](Index t, int corner) { return isDouble(v, mesh_.vertex(t, (corner + 1) % 3)); }))
        if (!flipDouble(v))
          return false;
      return true;
    });
  }

  bool isDouble(Index v, Index w) const {
    return !rims_.isVirtual(w) && !rims_.isEdge(v, w) &&
           (rims_.node_of[v] == rims_.node_of[w] || countEdges(v, w) > 1);
  }

  bool flipDouble(Index v) {
    return mesh_.anyAround(v, [&](Index t, int corner) {
      if (!isDouble(v, mesh_.vertex(t, (corner + 1) % 3)))
        return false;
      const auto at = mesh_.diamond(t, (corner + 2) % 3);
      const bool is_real = !rims_.isVirtual(at.c) && !rims_.isVirtual(at.d);
      return !(is_real &&
               (rims_.node_of[at.c] == rims_.node_of[at.d] || countEdges(at.c, at.d) > 0)) &&
             mesh_.flip(t, (corner + 2) % 3);
    });
  }

  /// Number of edges between copies of two nodes.
  int countEdges(Index v, Index w) const {
    int count = 0;
    for (const Index a : {v, rims_.twin[v]})
      for (const Index b : {w, rims_.twin[w]})
        count += a >= 0 && b >= 0 && mesh_.areJoined(a, b) ? 1 : 0;
    return count;
  }

  const CutGraph& cut_;
  const Rims& rims_;
  Index vertices_;
  SphereMesh mesh_;
  Indexed<Index> came_from_;  ///< the triangle before in a strip; -1
  IndexSet seen_;
};

}  // namespace

std::optional<Triangles> glue(std::size_t nodes, const CutGraph& cut, Triangles spheres,
                              std::size_t count, Index vertices) {
  const Rims rims(cut);
  turn(rims, vertices, spheres);
  Gluer gluer(cut, rims, spheres, vertices);
  if (!gluer.prepare())
    return std::nullopt;
  Triangles result = gluer.glued();
  if (result.cols() == 0 || result.minCoeff() < 0)
    return std::nullopt;
  const MeshTopology topology = checkTopology(result, nodes);
  const auto genus =
      static_cast<long long>(cut.rims.size() / 2 + 1) - static_cast<long long>(count);
  if (!topology.closed || !topology.isSurface() || topology.genus != genus)
    return std::nullopt;
  return result;
}

}  // namespace spherical_param::internal
