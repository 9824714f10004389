#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Maximum number of intersecting triangles of a usable mesh, or more where counting takes no time.
/// \see Surface::isUsable
inline std::size_t mostOfUsable(const Triangles& triangles) {
  return std::max<std::size_t>(static_cast<std::size_t>(triangles.cols()) / 100, 3000);
}

/// Pairs of triangles that intersect, ascending.
struct IntersectingPairs {
  std::vector<std::array<Index, 2>> pairs;
  bool is_sample = false;  ///< more triangles may intersect
};

/// Finds pairs of triangles that intersect, spread over the mesh, until more than a number of
/// triangles intersect. The same for any number of threads.
///
/// \param most that number.
/// \see findSelfIntersections
IntersectingPairs findPairsUpTo(std::size_t most, const Positions& points,
                                const Triangles& triangles, const Execution& execution);

}  // namespace spherical_param::internal
