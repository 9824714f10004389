#pragma once

#include "graph.h"
#include "tangent_stars.h"

#include <vector>

namespace spherical_param::internal {

/// Finds stray points: isolated points, small clusters, nets, and points between sheets.
///
/// The components of the agreed graph are surfaces, except
///
///   - clusters: components of fewer than 32 points,
///   - nets: components without a sheet of 32 points (joined by edges with triangles on both sides)
///     whose median distance of neighbours is above 5 times that of the surface beside.
///
/// A point of a cluster or net is stray if it is farther from the nearest surface than the mean
/// distance of neighbours there and 6 times the roughness, and in no star of a point of a surface.
/// The roughness is the RMS distance of some 12 points there from their plane.
///
/// \param points 3 x n, n >= 1.
/// \param agreed see agreedGraph().
/// \param stars  of the points.
/// \return ascending by point.
std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars);

}  // namespace spherical_param::internal
