#pragma once

#include "indexed.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The place of an entry among the three of a triangle; without branches, which would be
/// mispredicted.
inline int placeOf(Index entry, const std::array<Index, 3>& entries) {
  const int is_last = entries[2] == entry ? 1 : 0;
  return 2 * is_last + ((1 - is_last) & (entries[1] == entry ? 1 : 0));
}

/// Records changes of indices so that they can be undone. The indices must not move in memory.
class Journal {
public:
  /// Begins to record changes, or continues, until commit() or rollBack(). Returns the number of
  /// recorded changes.
  std::size_t record() {
    is_recording_ = true;
    return changes_.size();
  }
  void commit() {
    is_recording_ = false;
    changes_.clear();
  }
  /// Undoes all but the first changes; 0 also ends the recording.
  void rollBack(std::size_t first = 0) {
    for (; changes_.size() > first; changes_.pop_back())
      *changes_.back().first = changes_.back().second;
    if (first == 0)
      commit();
  }
  void set(Index& index, Index value) {
    if (is_recording_)
      changes_.emplace_back(&index, index);
    index = value;
  }

private:
  bool is_recording_ = false;
  std::vector<std::pair<Index*, Index>> changes_;  ///< indices and their old values
};

/// A closed triangle mesh with its adjacency: a sphere, a surface with handles, or several pieces.
/// Three moves keep it closed and manifold: split a triangle in three by a new vertex, merge the
/// three triangles around a vertex, flip an edge whose opposite vertices are not joined. Open
/// triangles are over openings; the others are the surface. Changes can be rolled back exactly.
class SphereMesh {
public:
  /// \param triangles closed, manifold, consistently oriented, at least 4 vertices in each piece,
  ///                  indices in range; see MeshTopology::isSphere().
  SphereMesh(const Triangles& triangles, std::size_t vertex_count, int threads = 1);
  SphereMesh() = default;

  /// Number of slots for triangles, used or free.
  Index size() const { return vertices_.count(); }
  std::size_t slotCount() const { return vertices_.size(); }
  /// The corners of a triangle, counter-clockwise.
  const std::array<Index, 3>& vertices(Index triangle) const { return vertices_[triangle]; }
  Index vertex(Index triangle, int corner) const {
    return vertices_[triangle][static_cast<std::size_t>(corner)];
  }
  /// The ends of the side opposite to `corner`.
  std::array<Index, 2> side(Index triangle, int corner) const {
    return {vertex(triangle, (corner + 1) % 3), vertex(triangle, (corner + 2) % 3)};
  }
  /// The triangle across the side opposite to `corner`.
  Index neighbor(Index triangle, int corner) const {
    return neighbors_[triangle][static_cast<std::size_t>(corner)];
  }
  /// The vertices of each of some triangles.
  template <typename Indices>
  std::vector<Index> verticesOf(const Indices& triangles) const {
    std::vector<Index> all;
    for (const Index t : triangles)
      all.insert(all.end(), vertices(t).begin(), vertices(t).end());
    return all;
  }
  int cornerOf(Index triangle, Index v) const { return placeOf(v, vertices_[triangle]); }
  /// The corner of neighbor(triangle, corner) that is opposite to the common side.
  int oppositeCorner(Index triangle, int corner) const {
    // The common side runs the other way round in the neighbour, from corner + 2 to corner + 1; the
    // opposite vertex follows its end.
    const Index end = vertex(triangle, (corner + 1) % 3);
    return (cornerOf(neighbor(triangle, corner), end) + 1) % 3;
  }
  bool isUsed(Index slot) const { return vertex(slot, 0) >= 0; }
  bool isOpen(Index triangle) const { return is_open_[triangle] != 0; }
  void setOpen(Index triangle, bool is_open) { journal_.set(is_open_[triangle], is_open ? 1 : 0); }
  /// The triangles of the surface, ascending.
  std::vector<Index> surface() const;
  /// Their corners.
  Triangles surfaceTriangles() const;
  std::size_t surfaceCount() const { return surface().size(); }
  bool hasOpen() const { return surfaceCount() < static_cast<std::size_t>(triangle_count_); }
  /// Number of vertices of the surface.
  std::size_t surfaceVertexCount() const;
  /// Number of handles of a mesh in one piece.
  std::size_t genus() const;

  /// A triangle at the vertex; -1 if the vertex is not in the mesh.
  Index triangleAt(Index vertex) const { return triangle_at_[vertex]; }
  Index degree(Index vertex) const { return degree_[vertex]; }

  /// Whether is(triangle, corner) is true for a triangle around a vertex of the mesh. Asks
  /// counter-clockwise and stops at the first.
  template <typename Predicate>
  bool anyAround(Index v, const Predicate& is) const {
    const Index first = triangleAt(v);
    Index t = first;
    do {
      const int corner = cornerOf(t, v);
      if (is(t, corner))
        return true;
      t = neighbor(t, (corner + 1) % 3);
    } while (t != first);
    return false;
  }
  /// Calls visit(triangle, corner) for the triangles around a vertex of the mesh,
  /// counter-clockwise.
  template <typename Visit>
  void forEachAround(Index v, const Visit& visit) const {
    anyAround(v, [&](Index t, int corner) {
      visit(t, corner);
      return false;
    });
  }

  /// Whether two vertices of the mesh have a common edge.
  bool areJoined(Index v, Index w) const;

  /// The vertices of two triangles with a common side: (c, a, b), and (d, b, a) beyond the side.
  struct Diamond {
    Index a, b, c, d;
  };
  /// The diamond of the side opposite to a corner, which is c.
  Diamond diamond(Index triangle, int corner) const {
    return {vertex(triangle, (corner + 1) % 3), vertex(triangle, (corner + 2) % 3),
            vertex(triangle, corner),
            vertex(neighbor(triangle, corner), oppositeCorner(triangle, corner))};
  }

  /// Splits a triangle in three by a vertex that is not in the mesh. The parts are the triangle
  /// itself and two new ones, open as it is; the new vertex is corner 0 of each.
  std::array<Index, 3> split(Index triangle, Index new_vertex);

  /// Removes a vertex of degree 3, unless the mesh is a tetrahedron. Returns the triangle that
  /// replaces its three, open if one of them is, or -1.
  Index merge(Index vertex);

  /// Replaces the side opposite to `corner` by the other diagonal of its diamond, if isFree().
  /// Returns whether it was. Corner 0 of both triangles is then the vertex that was at `corner`.
  bool flip(Index triangle, int corner);
  /// The same where the diamond is known to be free.
  void flipFree(Index triangle, int corner);

  /// Records moves. While it records, splits need slots freed by merge().
  Journal& journal() { return journal_; }

  /// The corners of all triangles, in the order of their slots.
  Triangles triangles() const;
  /// Turns the mesh inside out.
  void turnOver();

private:
  void setTriangle(Index t, const std::array<Index, 3>& vertices,
                   const std::array<Index, 3>& neighbors) {
    for (std::size_t k = 0; k < 3; ++k) {
      journal_.set(vertices_[t][k], vertices[k]);
      journal_.set(neighbors_[t][k], neighbors[k]);
    }
  }
  void addDegree(Index v, Index change) { journal_.set(degree_[v], degree(v) + change); }
  void replaceNeighbor(Index triangle, Index old_neighbor, Index new_neighbor) {
    auto& around = neighbors_[triangle];
    journal_.set(around[static_cast<std::size_t>(placeOf(old_neighbor, around))], new_neighbor);
  }
  /// A free slot for a triangle, the last freed one first.
  Index takeSlot();
  void freeSlot(Index t);

  Indexed<std::array<Index, 3>> vertices_;   ///< -1 and the next free slot, if free
  Indexed<std::array<Index, 3>> neighbors_;  ///< across the side opposite to each corner
  Indexed<Index> is_open_;                   ///< 1: the triangle is over an opening
  Indexed<Index> triangle_at_;
  Indexed<Index> degree_;
  Index free_ = -1;  ///< first free slot
  Index triangle_count_ = 0;
  Journal journal_;
};

/// Consecutive triangles around a vertex, counter-clockwise.
using Fan = std::vector<Index>;

/// The fans at a vertex: of open triangles, or of triangles of the surface.
std::vector<Fan> fansAt(const SphereMesh& mesh, Index v, bool of_open);

/// The triangles around a vertex, counter-clockwise.
Fan trianglesAround(const SphereMesh& mesh, Index v);

/// Whether the side of a diamond may be replaced by the other diagonal, whose ends are not joined.
inline bool isFree(const SphereMesh& mesh, const SphereMesh::Diamond& at) {
  return at.c != at.d && !mesh.areJoined(at.c, at.d);
}

}  // namespace spherical_param::internal
