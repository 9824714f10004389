#pragma once

#include "spherical_param/openings.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// A neighbour graph whose openings are filled by virtual nodes, so that it is that of a closed
/// surface.
struct FilledGraph {
  Graph graph;       ///< n nodes and the virtual ones
  Positions points;  ///< 3 x graph.size(), those of the nodes first
};

/// Fills each opening by rings of virtual nodes, each ring of half as many as the last one, and a
/// pole in the last ring of kMaxLastRing nodes or less: about as many more nodes as the loop has.
/// Rings are joined by triangles. The edges have the lengths that they have in a flat disc as large
/// as the opening. False edges of the graph are left out, but for those that keep it connected.
///
/// \param points   3 x n.
/// \param graph    n nodes.
/// \param openings loops of nodes, false edges.
FilledGraph fillOpenings(const Positions& points, const Graph& graph, const Openings& openings);

}  // namespace spherical_param::internal
