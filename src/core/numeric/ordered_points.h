#pragma once

#include "indexed.h"

#include <string>
#include <vector>

namespace spherical_param::internal {

/// The distinct points of a cloud, called nodes, in the order of a space-filling curve, so that
/// neighbours are close in memory.
struct OrderedPoints {
  /// 3 x v, column i = node i, scaled by 2^-exponent to an extent of about 1. Exact: distinct
  /// points stay distinct, and later products do not overflow.
  Positions points;
  int exponent = 0;
  Indexed<Index> input_of_node;  ///< v entries, the first input point at each

  // Vertices are the same points, numbered by the first input point.
  Indexed<Index> vertex_of_node;   ///< v entries, a permutation
  Indexed<Index> vertex_of_input;  ///< n entries
  Indexed<Index> input_of_vertex;  ///< v entries, ascending
};

/// Finds the distinct points (-0 equals +0) and sorts them as mortonOrder() does, at the cost of
/// one sort.
///
/// \param points 3 x n, finite, n < 2^31.
OrderedPoints orderPoints(const Positions& points, int threads);

/// orderPoints() with checks for meshing.
///
/// \throw InvalidInput for a coordinate that is not finite or too large, or fewer than four
/// distinct points.
OrderedPoints orderCheckedPoints(const Positions& points, int threads);

/// \throw InvalidInput, which names the function, if a point is not finite.
void checkFinite(const std::string& function, const Positions& points);

/// The node of each input point.
Indexed<Index> nodesOfInput(const OrderedPoints& nodes);

}  // namespace spherical_param::internal
