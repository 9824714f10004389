#pragma once

#include "neighbor_graph.h"
#include "tangent_stars.h"

#include <vector>

namespace spherical_param::internal {

/// Finds stray points: single ones, small clusters, nets of them, and points between sheets.
///
/// A stray point has no neighbours in the agreed graph, or others like it. The pieces of this graph
/// are surfaces, but for
///
///   - clusters: pieces of fewer than 32 points,
///   - nets: pieces of which no 32 points form a sheet (are joined by edges with triangles on both
///     sides) and whose median distance of neighbours is above 5 times that of the surface beside.
///
/// A point of a cluster or a net is stray if it is farther from the nearest surface than the mean
/// distance of neighbours there and 6 times the roughness, and in no star of a point of a surface.
/// The roughness is the root mean square distance of some 12 points there from their plane.
///
/// \param points 3 x n, n >= 1.
/// \param agreed see agreedGraph().
/// \param stars  of the points.
/// \return ascending by point.
std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars);

}  // namespace spherical_param::internal
