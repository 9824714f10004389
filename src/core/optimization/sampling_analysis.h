#pragma once

#include "graph.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// How a surface was sampled, judged by the neighbours of its points.
struct Sampling {
  /// How far the sampling follows the surface's curvature, in [-1, 1].
  ///
  /// Simplified and designed models have points farther apart along the direction of less
  /// curvature; scans and even samplings are independent of it. For some thousand points, the
  /// neighbours' spread in the tangent plane is compared with the curvature of a quadric through
  /// their neighbours' neighbours: 1 if the spread is always longest in the direction of least
  /// curvature, 0 if the two are independent or nothing can be compared.
  double alignment = 0.0;
  /// Standard deviation of the distances of a point's neighbours over their mean, on average.
  double unevenness = 0.0;
};

/// Analyses some thousand points, or all of a smaller cloud.
///
/// \param points 3 x n; \param graph of its neighbours.
Sampling analyzeSampling(const Positions& points, const Graph& graph, int threads);

/// Whether the sampling is even and independent of the surface's curvature.
bool isEvenlySampled(const Positions& points, const Graph& graph, int threads);

}  // namespace spherical_param::internal
