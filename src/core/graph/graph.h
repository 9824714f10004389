#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// Undirected graph in compressed rows: every edge is stored at both of its ends.
/// Rows are sorted by ascending neighbour, without repetition and without self-loops.
struct Graph {
  std::vector<std::size_t> offsets{0};  ///< n + 1 positions in `neighbors` and `lengths`
  std::vector<Index> neighbors;         ///< 2 x edges entries
  /// Euclidean length of each entry's edge [unit of the input]: finite and > 0, or 0 by rounding.
  std::vector<double> lengths;

  /// Number of nodes. \return n
  std::size_t size() const { return offsets.size() - 1; }
  /// Number of undirected edges. \return half the number of entries
  std::size_t edgeCount() const { return neighbors.size() / 2; }
};

}  // namespace spherical_param
