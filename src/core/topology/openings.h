#pragma once

#include "graph.h"
#include "indexed.h"
#include "rotation_system.h"
#include "spherical_param/result.h"

#include <array>
#include <vector>

namespace spherical_param {

/// The openings of a sampled surface.
struct Openings {
  std::vector<Opening> openings;      ///< the longest boundary first
  internal::Indexed<double> spacing;  ///< n entries: median length of the edges of each node
  /// Edges {lower, higher} of the graph that are not on the surface, ascending: across an opening,
  /// or from its loop to another sheet.
  std::vector<std::array<Index, 2>> false_edges;
  /// The surface has only one side, like a Moebius strip.
  bool is_one_sided = false;
};

namespace internal {

/// The opening within a loop, with its sizes.
Opening measured(const Positions& points, const Indexed<double>& spacing, std::vector<Index> loop);

/// Finds the openings of a sampled surface in its neighbour graph, before meshing, among the faces
/// of its rotation system.
///
/// A face is an opening if it has at least 7 edges, is at least 3 spacings wide, and has corners of
/// at least 117 degrees on average (narrow seams have sharp corners). A slit, longer than 5 times
/// the circumference of a disc of its width, must be 4 spacings wide. A flat patch without such a
/// face has an opening around it, unless it is narrower than a tenth of a spacing.
///
/// With openings, edges between opposite normals are dropped as well: near a loop they join the two
/// sides of a thin part. A one-sided surface keeps them.
///
/// \param points   3 x n, finite.
/// \param graph    n nodes, tangent Delaunay; bridges between parts do no harm.
/// \param spacing  of each node.
/// \param rotation of the graph; afterwards without edges between opposite sheets if there are
///                 openings.
/// \return the openings. Cost: O(n).
///
/// Not guaranteed: openings below some 5 spacings and seams between sheets that nearly touch may be
/// missed; a flat face of the surface without points inside counts as an opening.
Openings findOpenings(const Positions& points, const Graph& graph, const Indexed<double>& spacing,
                      RotationSystem& rotation);

/// Finds the points that sample the surface in an opening: those near its loop, if all of them are
/// also near the plane of the loop.
///
/// \param points 3 x n, of the openings.
/// \param others 3 x m.
/// \return columns of `others`, ascending.
std::vector<Index> pointsInOpenings(const Positions& points, const std::vector<Opening>& openings,
                                    const Positions& others);

}  // namespace internal

}  // namespace spherical_param
