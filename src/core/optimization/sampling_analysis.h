#pragma once

#include "graph.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// How a surface was sampled, as seen from the neighbours of its points.
struct Sampling {
  /// How far the sampling follows the surface's curvature, in [-1, 1].
  ///
  /// Points that a simplification or a designer left are farther apart along the direction in which
  /// the surface bends less; points of a scanner or of an even sampling do not know how it bends.
  /// For some thousand points, the neighbours' spread in the tangent plane is compared with the
  /// curvature of a quadric through their neighbours' neighbours: 1 if the spread is always longest
  /// where the surface bends least, 0 if the two have nothing to do with each other, or there is
  /// nothing to compare.
  double alignment = 0.0;
  /// Standard deviation of the distances of a point's neighbours over their mean, on the average.
  double unevenness = 0.0;
};

/// Looks at some thousand points, or all there are.
///
/// \param points 3 x n; \param graph of its neighbours.
Sampling analyzeSampling(const Positions& points, const Graph& graph, int threads);

}  // namespace spherical_param::internal
