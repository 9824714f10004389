#pragma once

#include "indexed.h"

#include <cstddef>
#include <utility>

namespace spherical_param::internal {

/// Disjoint sets of 0 ... n - 1; the representative of a set is its lowest element, so that results
/// do not depend on the order of the unions.
class UnionFind {
public:
  explicit UnionFind(std::size_t n) : parent_(firstIndices(n)) {}

  Index find(Index i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  /// Returns whether the two were in different sets.
  bool unite(Index i, Index j) {
    i = find(i);
    j = find(j);
    if (i == j)
      return false;
    if (j < i)
      std::swap(i, j);
    parent_[j] = i;
    return true;
  }

  std::size_t size() const { return parent_.size(); }

private:
  Indexed<Index> parent_;
};

/// The sets of a UnionFind, each named by its representative.
struct Partition {
  explicit Partition(UnionFind& sets) : of(sets.size()), sizes(sets.size(), 0) {
    for (Index i = 0; i < of.count(); ++i) {
      of[i] = sets.find(i);
      ++sizes[of[i]];
    }
  }

  Indexed<Index> of;           ///< the set of each element
  Indexed<std::size_t> sizes;  ///< number of elements of each set; 0 elsewhere
};

/// The connected pieces of a mesh, as sets of vertices; a vertex in no triangle is a piece by
/// itself.
inline UnionFind piecesOf(const Triangles& triangles, std::size_t vertices) {
  UnionFind pieces(vertices);
  for (const auto& t : triangles.colwise()) {
    pieces.unite(t[0], t[1]);
    pieces.unite(t[0], t[2]);
  }
  return pieces;
}

/// The number of triangles of each piece, by the vertex that find() returns.
inline Indexed<Index> sizesOf(const Triangles& triangles, std::size_t vertices, UnionFind& pieces) {
  Indexed<Index> sizes(vertices, 0);
  for (const auto& t : triangles.colwise())
    ++sizes[pieces.find(t[0])];
  return sizes;
}

}  // namespace spherical_param::internal
