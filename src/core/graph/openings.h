#pragma once

#include "graph.h"
#include "spherical_param/execution.h"
#include "spherical_param/result.h"

#include <array>
#include <vector>

namespace spherical_param {

/// \addtogroup neighbor_graph
/// @{

/// The openings of a sampled surface.
struct Openings {
  std::vector<Opening> openings;  ///< the longest boundary first
  std::vector<double> spacing;    ///< n entries: median length of the edges of each node
  /// Edges {lower, higher} of the graph that are none of the surface, ascending: those across an
  /// opening, and those from its loop to another sheet.
  std::vector<std::array<Index, 2>> false_edges;
  /// The surface has openings, and one side only, like a band of Moebius: no orientation of the
  /// normals fits.
  bool is_one_sided = false;
};

/// Finds the openings of a sampled surface in its neighbour graph, before there is any mesh.
///
/// Edges longer than 1.5 times the larger spacing of their ends are left out. The directions to the
/// neighbours within two steps have a plane of least variance; its normals are oriented along edges
/// between similar normals first (Hoppe et al. 1992). Of edges that cross, the longer one is left
/// out, and so are edges that are steep to a plane and join different normals. In the order of the
/// neighbours around the normals all faces of the graph are traced. One is an opening if it has at
/// least 7 edges, is at least 3 spacings wide, and has corners of at least 117 degrees in the mean:
/// those of narrow seams are sharp. A slit, longer than 5 times the edge of a disc as wide, must be
/// 4 spacings wide. A flat patch in which no face is wide enough has an opening around it even so,
/// unless it is narrower than a tenth of a spacing.
///
/// If there are openings, edges between opposite normals are left out as well: near a loop they
/// join the two sides of a thin part. Not so if the surface has one side only: then many of them
/// are not steep to their planes, and the graph has no cycles when the openings are filled.
///
/// \param points 3 x n, finite.
/// \param graph  n nodes, local Delaunay neighbourhoods; bridges between parts do no harm.
/// \param execution threads
/// \return the openings, the same, bit by bit, for any number of threads.
/// Cost: O(n).
///
/// Not guaranteed: openings of less than some 5 spacings are not seen, seams between sheets that
/// nearly touch neither; a flat face of the surface without points inside is an opening, too.
Openings findOpenings(const Positions& points, const Graph& graph, const Execution& execution = {});

/// @}

}  // namespace spherical_param
