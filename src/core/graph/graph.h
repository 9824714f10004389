#pragma once

#include "rows.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// Undirected graph in compressed rows: every edge is stored at both of its ends.
/// Rows are sorted by ascending neighbour, without repetition and without self-loops.
struct Graph : internal::NeighborRows {
  /// Euclidean length of each entry's edge [unit of the input]: finite and > 0, or 0 by rounding.
  std::vector<double> lengths;

  /// Number of undirected edges. \return half the number of entries
  std::size_t edgeCount() const { return neighbors.size() / 2; }
  /// Lengths of the edges of a node.
  internal::Row<double> lengthsOf(Index node) const {
    return {lengths.data() + begin(node), lengths.data() + end(node)};
  }
};

}  // namespace spherical_param
