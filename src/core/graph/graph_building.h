#pragma once

#include "graph.h"
#include "parallel.h"
#include "union_find.h"

#include <cstddef>
#include <vector>

/// Common functions of both neighbour graphs.
namespace spherical_param::internal {

/// A graph, or a matrix with the lengths as entries, whose rows several threads find.
///
/// \param find (begin, end, rows) appends the rows of a block [begin, end).
template <typename Find>
Graph rowsOfBlocks(std::size_t count, int threads, const FractionReport& report, const Find& find) {
  std::vector<Graph> blocks((count + kBlockSize - 1) / kBlockSize);
  forEachBlock(count, threads, report, [&](std::size_t b, std::size_t begin, std::size_t end) {
    find(static_cast<Index>(begin), static_cast<Index>(end), blocks[b]);
  });
  Graph all;
  all.offsets.reserve(count + 1);
  std::size_t entries = 0;
  for (const Graph& block : blocks) {
    for (const Index row : block.nodes())
      all.offsets.push_back(entries + block.end(row));
    entries += block.neighbors.size();
  }
  all.neighbors.reserve(entries);
  all.lengths.reserve(entries);
  for (const Graph& block : blocks) {
    all.neighbors.insert(all.neighbors.end(), block.neighbors.begin(), block.neighbors.end());
    all.lengths.insert(all.lengths.end(), block.lengths.begin(), block.lengths.end());
  }
  return all;
}

/// Length of an edge; positive even if the squares underflow.
double edgeLength(const Positions& points, Index i, Index j);

/// Point spacing at a node: the median length of its edges, robust against long edges across an
/// opening; 0 without edges.
double nodeSpacing(const Graph& graph, Index node);

/// The connected components of a graph.
UnionFind connectedComponents(const NeighborRows& graph);

/// Minimum spanning tree of the components by their closest pairs of points (Boruvka 1926): in each
/// round every component but the largest finds its shortest edge to another one.
///
/// \param points            3 x n.
/// \param parts             the components of n nodes; one set afterwards.
/// \param bridges_per_joint maximum number of bridges between two joined components; >= 1.
std::vector<Bridge> shortestBridges(const Positions& points, UnionFind& parts,
                                    int bridges_per_joint);

/// Up to `count` bridges for each leaf of the block-cut tree, a biconnected component that hangs by
/// one articulation point: its closest pairs with points outside, without that node, with different
/// ends. Empty if and only if the graph is biconnected, or components have no points to join.
///
/// \param points 3 x n.
/// \param graph  n nodes, connected.
std::vector<Bridge> articulationBridges(const Positions& points, const Graph& graph, int count);

/// The graph with more edges: of equal ones the shortest, unless the graph has it.
///
/// \param nodes minimum number of nodes of the result; the graph's come first.
Graph withEdges(const Graph& graph, const std::vector<Bridge>& edges, std::size_t nodes = 0);

}  // namespace spherical_param::internal
