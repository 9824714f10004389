#pragma once

#include "neighbor_graph.h"
#include "spherical_param/types.h"

#include "union_find.h"

#include <cstddef>
#include <vector>

/// What both ways of making a neighbour graph share.
namespace spherical_param::internal {

/// Length of an edge; positive for distinct points even where the squares underflow.
double edgeLength(const Positions& points, Index i, Index j);

/// The connected components of a graph.
UnionFind connectedComponents(const Graph& graph);

/// The representative of the set of each of 0 ... n - 1.
std::vector<Index> representatives(UnionFind& sets, std::size_t n);

/// Number of disjoint sets, by their representatives.
Index countSets(const std::vector<Index>& representative);

/// Number of elements of each set, at its representative; 0 elsewhere.
std::vector<std::size_t> setSizes(const std::vector<Index>& representative);

/// Minimum spanning tree of the components by their closest pairs of points (Boruvka 1926): in each
/// round every component but the largest finds its shortest edge to another one.
///
/// \param points            3 x n.
/// \param parts             the components of n nodes; one set afterwards.
/// \param bridges_per_joint each two components that are joined get up to this number of bridges; 1
/// and up.
std::vector<Bridge> shortestBridges(const Positions& points, UnionFind& parts,
                                    int bridges_per_joint);

/// Up to `count` more bridges for each of `joints`: the closest pairs of the two components, with
/// ends that no other bridge of the joint has.
///
/// \param points 3 x n.
/// \param part   n entries, the component of each point before it was joined: a node of it.
/// \param joints one bridge for each two components that were joined.
std::vector<Bridge> furtherBridges(const Positions& points, const std::vector<Index>& part,
                                   const std::vector<Bridge>& joints, int count);

/// Up to `count` bridges for each part of the graph that a single node joins to the others and that
/// holds no such part itself: its closest pairs with points outside, that node left out, with ends
/// that are all different. Empty if and only if no node alone joins two parts, or a part has no
/// points to join.
///
/// \param points 3 x n.
/// \param graph  n nodes, connected.
std::vector<Bridge> articulationBridges(const Positions& points, const Graph& graph, int count);

/// The graph with further edges; repetitions, also of edges that it holds already, do no harm.
Graph withEdges(const Graph& graph, const std::vector<Bridge>& edges);

}  // namespace spherical_param::internal
