#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <array>
#include <vector>

namespace spherical_param::internal {

/// A mesh with vertices added over its filled openings.
struct SmoothFill {
  Positions points;            ///< 3 x (n + a): those given, then those added [unit of the input]
  std::vector<Index> nearest;  ///< a entries: the given vertex nearest to each added one
  /// 3 x m': the first m take the places of those given.
  Triangles triangles;
  std::vector<Index>
      opening_of;             ///< m' - m entries: the opening that each further triangle is over
  std::vector<Index> filled;  ///< openings with added vertices, ascending
  std::vector<std::array<Index, 2>> self_intersections;  ///< as findSelfIntersections()
};

/// Refines the triangles over filled openings to the density around them, and bends them so that
/// they go on as the surface around does (Liepa 2003: Filling holes in meshes). Where they would
/// intersect more than before, they bend less, or stay as they are. The given points stay.
///
/// \param points 3 x n; \param triangles 3 x m, manifold, oriented.
/// \param openings for each its triangles, in one opening only. Those that form no disc stay.
/// \param execution threads, progress and cancellation.
/// \return the mesh, of the same topology; the same, bit by bit, for any number of threads.
SmoothFill fillSmoothly(const Positions& points, const Triangles& triangles,
                        const std::vector<std::vector<Index>>& openings,
                        const Execution& execution);

/// The same for a finished surface, whose figures follow. One with more intersections than were
/// listed stays.
///
/// \param cloud 3 x n, the input; \param options threads and details.
/// \param execution threads, progress and cancellation.
/// \param surface in the unit and the numbers of the input, changed in place.
void fillSmoothly(const Positions& cloud, const Options& options, const Execution& execution,
                  Surface& surface);

}  // namespace spherical_param::internal
