#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Maximum number of intersecting triangles of a usable mesh; at least 3,000, which are counted in
/// no time. \see Surface::isUsable
inline std::size_t mostOfUsable(std::size_t triangles) {
  return std::max<std::size_t>(triangles / 100, 3000);
}

/// Pairs of triangles that intersect.
struct IntersectingPairs {
  std::vector<std::array<Index, 2>> pairs;  ///< {lower, higher}, ascending
  bool is_sample = false;                   ///< the search ended early: there may be more

  bool areFewerThan(const IntersectingPairs& other) const {
    return std::pair(is_sample, pairs.size()) < std::pair(other.is_sample, other.pairs.size());
  }
};

/// Finds pairs of triangles that intersect, spread over the mesh, until more than `most` triangles
/// intersect. The same for any number of threads. \see findSelfIntersections
IntersectingPairs findPairsUpTo(std::size_t most, const Positions& points,
                                const Triangles& triangles, const Execution& execution);

/// The same among some of the triangles, in the numbers of all. \param some ascending.
IntersectingPairs findPairsUpTo(std::size_t most, const Positions& points,
                                const Triangles& triangles, const std::vector<Index>& some,
                                const Execution& execution);

}  // namespace spherical_param::internal
