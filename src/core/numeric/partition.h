#pragma once

#include "rows.h"

#include <cstddef>
#include <numeric>
#include <vector>

namespace spherical_param::internal {

/// The nodes of each part of a partition, ascending: row p has those of part p.
///
/// \param part the part of each node, in [0, count).
inline NeighborRows nodesOfParts(const std::vector<Index>& part, std::size_t count) {
  NeighborRows rows;
  Indexed<std::size_t> next(count + 1, 0);
  for (const Index p : part)
    ++next[p + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  rows.offsets.assign(next.begin(), next.end());
  rows.neighbors.resize(part.size());
  Index node = 0;
  for (const Index p : part)
    rows.neighbors[next[p]++] = node++;
  return rows;
}

}  // namespace spherical_param::internal
