#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Disjoint sets of 0 ... n - 1; the representative of a set is its lowest element, so that results
/// do not depend on the order of the unions.
class UnionFind {
public:
  explicit UnionFind(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }

  Index find(Index i) {
    while (parent(i) != i) {
      parent(i) = parent(parent(i));
      i = parent(i);
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
    parent(j) = i;
    return true;
  }

private:
  Index& parent(Index i) { return parent_[static_cast<std::size_t>(i)]; }

  std::vector<Index> parent_;
};

}  // namespace spherical_param::internal
