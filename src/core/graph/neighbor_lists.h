#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace spherical_param::internal {

/// Refuses lists that are not `count` lists of indices in [0, n).
///
/// \param what what the lists are, or the public function that was given them, for the message.
inline void checkIndices(const std::string& what, const NeighborLists& lists, std::size_t count,
                         std::size_t n) {
  if (lists.offsets.size() != count + 1 || lists.offsets.front() != 0 ||
      lists.offsets.back() != lists.indices.size() ||
      !std::is_sorted(lists.offsets.begin(), lists.offsets.end()))
    throw InvalidInput(what + ": the neighbour lists do not fit " + std::to_string(count) +
                       " points; give one more offset than points, ascending from 0 to the number "
                       "of indices");
  for (const Index j : lists.indices)
    if (j < 0 || static_cast<std::size_t>(j) >= n)
      throw InvalidInput(what + ": neighbour " + std::to_string(j) + " of " + std::to_string(n) +
                         " points; indices must be in [0, n)");
}

/// Refuses lists that are not n lists of indices in [0, n).
inline void checkNeighborLists(const std::string& function, const NeighborLists& lists,
                               std::size_t n) {
  checkIndices(function, lists, n, n);
}

}  // namespace spherical_param::internal
