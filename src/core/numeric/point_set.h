#pragma once

#include "indexed.h"
#include "spherical_param/types.h"

namespace spherical_param {

/// \addtogroup point_set
/// @{

/// Partition of points by exact equality of their coordinates (-0 equals +0).
struct DistinctPoints {
  /// n entries: vertex of each input point, in [0, input_of_vertex.size()).
  internal::Indexed<Index> vertex_of_input;
  /// One entry per distinct position: the first input point at that position, ascending.
  internal::Indexed<Index> input_of_vertex;
};

/// Tells whether all points lie exactly in one plane (or line, or point), in exact arithmetic on
/// the given doubles: a cloud that is flat but for rounding is not coplanar.
///
/// \param points 3 x n, finite, of any magnitude.
/// \return true if they do, and for fewer than four points.
/// \throw InvalidInput if a coordinate of four points and more is not finite.
/// Cost: O(n); some microseconds for each point of an oblique plane.
bool areCoplanar(const Positions& points);

/// @}

}  // namespace spherical_param
