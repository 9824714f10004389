#pragma once

#include "filled_graph.h"
#include "graph.h"
#include "handles.h"
#include "indexed.h"
#include "openings.h"
#include "rotation_system.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// A neighbour graph that is cut along loops.
struct CutGraph {
  Graph graph;       ///< the n nodes, then the right copies of those of the loops
  Positions points;  ///< 3 x graph.size()
  /// The node that each was cut from: itself, or one of n.
  Indexed<Index> node_of;
  /// Two for each loop, the left and the right one: its copies, with the surface on the left.
  std::vector<std::vector<Index>> rims;
};

/// Cuts a graph along disjoint loops: doubles their nodes, gives each neighbour to the copy on its
/// side, and drops edges that cross a loop.
CutGraph cutAlong(const Positions& points, const Graph& graph, const RotationSystem& rotation,
                  const std::vector<CutLoop>& loops);

/// A cut graph with virtual nodes in its rims, then further ones in openings: that of spheres.
struct FilledCut {
  FilledGraph filled;
  Index in_rims = 0;  ///< number of nodes without those in the openings
};

/// Fills the rims of a cut graph, and openings that are apart from them.
FilledCut fillCut(const CutGraph& cut, const Openings& openings);

}  // namespace spherical_param::internal
