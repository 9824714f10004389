#pragma once

#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A closed genus-0 triangle mesh with neighbours, changed only by moves that keep it one: a
/// triangle is split in three by a new vertex, or an edge is flipped whose opposite vertices are
/// not yet joined.
class SphereMesh {
public:
  /// \param triangles closed, manifold, consistently oriented, genus 0, on at least 4 vertices.
  SphereMesh(const Triangles& triangles, std::size_t vertex_count);

  Index size() const { return static_cast<Index>(vertices_.size()); }
  Index vertex(Index triangle, int corner) const {
    return vertices_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(corner)];
  }
  /// The triangle across the side opposite to `corner`.
  Index neighbor(Index triangle, int corner) const {
    return neighbors_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(corner)];
  }
  /// The corner of neighbor(triangle, corner) that is opposite to the common side.
  int oppositeCorner(Index triangle, int corner) const;
  /// A triangle that has the vertex, or -1.
  Index triangleAt(Index vertex) const { return triangle_at_[static_cast<std::size_t>(vertex)]; }

  /// Splits a triangle in three by a vertex that is not in the mesh yet. The parts are the
  /// triangle itself and the last two; the new vertex is corner 0 of each.
  std::array<Index, 3> split(Index triangle, Index new_vertex);

  /// Replaces the side opposite to `corner` by the other diagonal of the two triangles, unless
  /// its ends are joined already: returns whether it did. The triangle keeps the vertex of
  /// `corner`, as corner 0; the neighbour has it as corner 0 too.
  bool flip(Index triangle, int corner);

  Triangles triangles() const;

private:
  bool areJoined(Index v, Index w) const;
  int cornerOf(Index triangle, Index vertex) const;
  void replaceNeighbor(Index triangle, Index old_neighbor, Index new_neighbor);

  std::vector<std::array<Index, 3>> vertices_;
  std::vector<std::array<Index, 3>> neighbors_;  ///< across the side opposite to each corner
  std::vector<Index> triangle_at_;
  std::vector<Index> degree_;
};

}  // namespace spherical_param::internal
