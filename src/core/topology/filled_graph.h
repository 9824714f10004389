#pragma once

#include "openings.h"
#include "spherical_param/types.h"

#include <array>
#include <vector>

namespace spherical_param::internal {

/// The neighbour graph of a closed surface: virtual nodes fill its openings.
struct FilledGraph {
  Graph graph;       ///< n nodes and the virtual ones
  Positions points;  ///< 3 x graph.size(), the nodes first
  /// For each opening the number of nodes up to its last virtual one.
  std::vector<Index> ends;
};

/// Fills each opening by a ringed disc within the loop, with up to 2.4 times as many virtual nodes
/// as the loop. Drops false edges of the graph unless they keep it connected.
///
/// \param points   3 x n.
/// \param graph    n nodes.
/// \param openings loops of nodes, false edges.
FilledGraph fillOpenings(const Positions& points, const Graph& graph, const Openings& openings);

/// A graph without false edges, except those that keep it connected.
///
/// \param points      3 x n.
/// \param false_edges {lower, higher}, ascending.
Graph withoutFalseEdges(const Positions& points, const Graph& graph,
                        const std::vector<std::array<Index, 2>>& false_edges);

}  // namespace spherical_param::internal
