#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// Pairs of triangles of a mesh that intersect more than neighbours must.
///
/// Vertices are the same if their coordinates are equal. Two triangles intersect if they
///  - have no vertex in common, and a point in common: touching counts,
///  - have one vertex in common, and the side opposite to it in one of them meets the other,
///  - have two vertices in common, and are folded flat onto each other: coplanar, with both third
///    vertices on the same side of the common side,
///  - have three vertices in common.
/// Triangles whose corners lie on one line, or that name a vertex twice, are left out: they have no
/// area that could intersect. Decided in exact arithmetic on the given doubles, unless coordinates
/// differ in their last digits by less than 1e-100 of the largest coordinate, where products
/// underflow.
///
/// \param points    3 x n, finite, any unit.
/// \param triangles 3 x m, indices in [0, n); need not be closed, manifold or oriented.
/// \param execution threads, progress
/// \return {lower, higher} indices of triangles, ascending, each pair once.
/// \throw InvalidInput for an index out of range, a coordinate that is not finite, threads outside
/// [0, 1024]; Cancelled. Cost: O(m log m) and the pairs whose bounding boxes overlap.
std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const Execution& execution = {});

/// The pairs of which at least one triangle is in a set: what has to be asked again after that set
/// has changed.
///
/// \param points    3 x n, finite, any unit.
/// \param triangles 3 x m, indices in [0, n).
/// \param of        triangles, in [0, m), any order; repetitions count once.
/// \param execution threads, progress
/// \return {lower, higher} indices of triangles, ascending, each pair once.
/// \throw as findSelfIntersections().
/// Cost: O(m) and that of the set.
std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution = {});

/// The number of different triangles in some pairs.
///
/// \param pairs in any order.
/// \return 0 if there are none.
std::size_t countTriangles(const std::vector<std::array<Index, 2>>& pairs);

/// @}

}  // namespace spherical_param
