#pragma once

#include "point_set.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::reference {

/// Distinct points, and their order along a space-filling curve.
struct OrderedPoints {
  DistinctPoints distinct;
  std::vector<Index> vertex_of_node;  ///< v entries, a permutation: the vertices along the curve
  Positions points;                   ///< 3 x v, the vertices along the curve, scaled
};

/// What internal::orderPoints() is to find, in two steps: distinct points by a hash table, then a
/// sort by comparison of where they are on the curve; ties go by vertex.
///
/// \param points 3 x n, finite, of an extent whose powers of two are normal numbers.
/// \param exponent of the power of two that the points are divided by.
OrderedPoints orderPoints(const Positions& points, int exponent);

}  // namespace spherical_param::reference
