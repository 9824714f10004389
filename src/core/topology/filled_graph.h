#pragma once

#include "openings.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A neighbour graph whose openings are filled by virtual nodes: that of a closed surface.
struct FilledGraph {
  Graph graph;       ///< n nodes and the virtual ones
  Positions points;  ///< 3 x graph.size(), those of the nodes first
};

/// Fills each opening by a ringed disc whose rim is the loop, with up to 2.4 times as many virtual
/// nodes as the loop. Drops false edges of the graph unless they keep it connected.
///
/// \param points   3 x n.
/// \param graph    n nodes.
/// \param openings loops of nodes, false edges.
FilledGraph fillOpenings(const Positions& points, const Graph& graph, const Openings& openings);

/// The graph of the n nodes alone of a filled graph.
Graph withoutVirtualNodes(const FilledGraph& filled, std::size_t nodes);

/// A graph without false edges, which are {lower, higher}, ascending.
Graph withoutFalseEdges(const Graph& graph, const std::vector<std::array<Index, 2>>& false_edges);

}  // namespace spherical_param::internal
