#pragma once

#include "graph.h"
#include "tangent_stars.h"

#include <cstddef>
#include <vector>

// The surfaces of a cloud are the connected components of its agreed graph (see agreedGraph()),
// together with small ones beside them. A point of another component is beside a surface if it is
// in a star of one of its points, or within the mean distance of neighbours there plus 6 times the
// roughness, the RMS distance of some 12 points there from their plane.

namespace spherical_param::internal {

/// Joins sheets along their boundaries. Where the spacing jumps at a sharp edge, as from contours
/// to the cap of a tube, the stars on the coarse side reach the fine side, but not the other way
/// round. If as many points of a sheet reach another sheet as a boundary has, these edges are
/// added.
///
/// \param agreed \see agreedGraph
/// \return the graph with these edges.
Graph joinedAlongBoundaries(const Positions& points, Graph agreed, const Stars& stars);

/// Splits a cloud into its surfaces.
///
/// Small components beside large ones belong to these. Other components of fewer than `min_points`
/// nodes are no parts: their nodes join the nearest part if they are beside it.
///
/// No guarantees: surfaces that touch are one part, and sparse stray points may form a part.
///
/// \param points 3 x n, the nodes.
/// \param stars  of the nodes.
/// \return n entries: a node that represents the part of each node; -1: no part.
Indexed<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                       std::size_t min_points);

/// Finds stray points: isolated points, small clusters, nets, and points between sheets.
///
/// All components are surfaces except
///
///   - clusters: components of fewer than 32 points,
///   - nets: components without a sheet of 32 points (joined by edges with triangles on both sides)
///     whose median distance of neighbours is above 5 times that of the surface beside them.
///
/// Their points are stray unless they are beside a surface.
///
/// \param points 3 x n, n >= 1.
/// \param stars  of the points.
/// \return ascending by point.
std::vector<StrayPoint> strayPoints(const Positions& points, const Graph& agreed,
                                    const Stars& stars);

}  // namespace spherical_param::internal
