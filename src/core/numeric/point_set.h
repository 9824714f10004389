#pragma once

#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup point_set
/// @{

/// Partition of points by exact equality of their coordinates (-0 equals +0).
struct DistinctPoints {
  /// n entries: vertex of each input point, in [0, input_of_vertex.size()).
  std::vector<Index> vertex_of_input;
  /// One entry per distinct position: the first input point at that position, ascending.
  std::vector<Index> input_of_vertex;
};

/// Finds the points that share all three coordinates.
///
/// \param points 3 x n, finite.
/// \return the vertex of each point, and the first point of each vertex.
/// \throw InvalidInput if a coordinate is not finite or n exceeds 2^30. Cost: O(n log n).
DistinctPoints findDistinctPoints(const Positions& points);

/// An order of the points, 0 ... n - 1, in which those that are near in space are mostly near:
/// along a space-filling curve (G. M. Morton, 1966). Work that visits points in it finds their
/// neighbours in the processor's cache.
///
/// \param points 3 x n, finite.
/// \return a permutation of 0 ... n - 1.
/// \throw InvalidInput if a coordinate is not finite. Cost: O(n log n).
std::vector<Index> spatialOrder(const Positions& points);

/// Tells whether all points lie exactly in one plane (or line, or point), in exact arithmetic on
/// the given doubles: a cloud that is flat but for rounding is not coplanar.
///
/// \param points 3 x n, finite, of any magnitude.
/// \return true if they do, and for fewer than four points.
/// \throw InvalidInput if a coordinate of four points and more is not finite.
/// Cost: O(n); a hundred times as much where coordinates other than 0 are below 1e-80 or above 1e80
/// and all points lie in one plane, or nearly all.
bool areCoplanar(const Positions& points);

/// @}

}  // namespace spherical_param
