#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// Finds the pairs of triangles of a mesh that intersect beyond shared vertices and edges.
///
/// Vertices are the same if their coordinates are equal. Two triangles intersect if they
///  - share no vertex but a point (touching counts),
///  - share one vertex, and the side opposite to it in one of them meets the other,
///  - share two vertices and are folded flat onto each other: coplanar, with both third vertices on
///    the same side of the shared edge,
///  - share three vertices.
/// Degenerate triangles (collinear corners, repeated vertices) are skipped. Exact on the given
/// doubles, unless coordinates differ by less than 1e-100 of the largest one, where products
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

/// Finds the pairs with at least one triangle in a set, for updates after that set has changed.
///
/// \param points    3 x n, finite, any unit.
/// \param triangles 3 x m, indices in [0, n).
/// \param of        the set: triangles in [0, m), in any order, perhaps repeated.
/// \param execution threads, progress
/// \return {lower, higher} indices of triangles, ascending, each pair once.
/// \throw as findSelfIntersections().
/// Cost: O(m), and the cost of the set.
std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution = {});

/// Number of different triangles in some pairs.
///
/// \param pairs in any order.
/// \return the number.
std::size_t countTriangles(const std::vector<std::array<Index, 2>>& pairs);

/// Sets triangle_mark::self_intersection for the triangles in some pairs, and clears it for others.
///
/// \param pairs in any order.
/// \param marks of each triangle; none if they are not wanted.
void markSelfIntersections(const std::vector<std::array<Index, 2>>& pairs,
                           std::vector<std::uint8_t>& marks);

/// @}

}  // namespace spherical_param
