#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Beyond this number of intersecting triangles, a mesh of some triangles is not usable. Counting
/// up to 3,000 takes no time. \see Surface::isUsable
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

/// Finds pairs of triangles that intersect, spread over the mesh, until more than a number of
/// triangles intersect. The same for any number of threads.
///
/// \param most that number.
/// \see findSelfIntersections
IntersectingPairs findPairsUpTo(std::size_t most, const Positions& points,
                                const Triangles& triangles, const Execution& execution);

/// The same among some triangles, as columns of all of them.
///
/// \param some ascending.
IntersectingPairs findPairsUpTo(std::size_t most, const Positions& points,
                                const Triangles& triangles, const std::vector<Index>& some,
                                const Execution& execution);

}  // namespace spherical_param::internal
