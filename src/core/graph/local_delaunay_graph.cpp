#include "local_delaunay_graph.h"

#include "component_tree.h"
#include "graph_building.h"
#include "progress.h"

#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Edges between points without a tangent plane that only one of them finds near: their
/// neighbourhood is the same from both ends, but for the ends of the lists.
std::vector<Bridge> edgesWithoutPlane(const Positions& points, const Stars& stars) {
  std::vector<Bridge> edges;
  for (const Index i : indicesOf(stars))
    if (!stars[i].tangent_plane)
      for (const Index j : stars.of(i))
        if (!stars[j].tangent_plane && !stars.of(j).contains(i))
          edges.push_back({i, j, edgeLength(points, i, j)});
  return edges;
}

/// The edges from points of low degree to their whole star and their nearest points.
std::vector<Bridge> edgesOfWeak(const Positions& points, const Stars& stars, const Graph& graph) {
  // Degree below which a point is repaired. Below 4 would be too generous: it brings back edges
  // that one star alone saw, across gaps; a model then has 1,203 self-intersections instead of 0.
  // With 0, a pair of elephants has 2,093,249 instead of 77,968.
  constexpr std::size_t min_degree = 3;
  std::vector<Bridge> edges;
  std::optional<ComponentTree> tree;
  for (const Index i : graph.nodes()) {
    if (graph.row(i).size() >= min_degree)
      continue;
    for (const Index j : stars.of(i))
      edges.push_back({i, j, edgeLength(points, i, j)});
    if (!tree)
      tree.emplace(points);
    std::vector<Index> nearest;
    while (nearest.size() < min_degree) {
      ComponentTree::Pair pair;
      tree->findNearest(i, nearest, pair);
      if (pair.from < 0)
        break;  // there are no others
      nearest.push_back(pair.from == i ? pair.to : pair.from);
      edges.push_back({i, nearest.back(), edgeLength(points, i, nearest.back())});
    }
  }
  return edges;
}

}  // namespace

Graph agreedGraph(const Positions& points, const Stars& stars, const Execution& execution) {
  return rowsOfBlocks(stars.size(), threadCount(execution.threads, stars.size()),
                      reportOf(execution, "graph"), [&](Index begin, Index end, Graph& rows) {
                        for (const Index i : NumberRange(begin, end)) {
                          for (const Index j : stars.of(i))
                            if (stars.of(j).contains(i)) {
                              rows.neighbors.push_back(j);
                              rows.lengths.push_back(edgeLength(points, i, j));
                            }
                          rows.endRow();
                        }
                      });
}

NeighborGraph buildLocalDelaunayGraph(const Positions& points, const Stars& stars, Graph agreed,
                                      const Execution& execution) {
  // Bridges of each pair of components that are joined: one alone lets a part dangle, and collapse
  // in the embedding. With 1 or 2, two spheres have 962 or 780 self-intersections instead of 0.
  constexpr int bridges_per_joint = 3;
  NeighborGraph result;
  if (stars.size() == 0)
    return result;
  Graph& graph = result.graph;
  graph = std::move(agreed);
  const auto add = [&](const std::vector<Bridge>& edges) {
    if (!edges.empty())
      graph = withEdges(graph, edges);
  };
  add(edgesWithoutPlane(points, stars));
  add(edgesOfWeak(points, stars, graph));
  reportFraction(reportOf(execution, "graph"), 0.0);
  UnionFind parts = connectedComponents(graph);
  result.bridges = shortestBridges(points, parts, bridges_per_joint);
  add(result.bridges);
  // Parts that only one node joins to the others are tied, too: they would collapse. Of parts in a
  // chain only the ends: needles have such chains, and gained nothing from more rounds.
  const std::vector<Bridge> ties = articulationBridges(points, graph, bridges_per_joint - 1);
  add(ties);
  result.bridges.insert(result.bridges.end(), ties.begin(), ties.end());
  return result;
}

}  // namespace spherical_param::internal
