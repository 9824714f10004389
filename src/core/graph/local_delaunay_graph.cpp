#include "local_delaunay_graph.h"

#include "component_tree.h"
#include "graph_building.h"
#include "progress.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Joins points without a tangent plane that only one of them finds near: their neighbourhood is
/// the same from both ends, but for the ends of the lists.
void joinWithoutPlane(const Positions& points, const Stars& stars, Graph& graph) {
  std::vector<Bridge> edges;
  for (const Index i : graph.nodes())
    if (!stars.kind[i].tangent_plane)
      for (const Index j : stars.of(i))
        if (!stars.kind[j].tangent_plane && !stars.of(j).contains(i))
          edges.push_back({i, j, edgeLength(points, i, j)});
  if (!edges.empty())
    graph = withEdges(graph, edges);
}

/// Gives points of low degree their whole star and their nearest points.
void repairWeak(const Positions& points, const Stars& stars, Graph& graph) {
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
      tree->nearestOther(i, nearest, pair);
      if (pair.from < 0)
        break;  // there are no others
      nearest.push_back(pair.from == i ? pair.to : pair.from);
      edges.push_back({i, nearest.back(), edgeLength(points, i, nearest.back())});
    }
  }
  if (!edges.empty())
    graph = withEdges(graph, edges);
}

/// Joins components, and ties each part that only one node joins to the others: it would collapse.
/// Of parts in a chain only the ends: needles have such chains, and gained nothing from more
/// rounds.
void connect(const Positions& points, const FractionReport& report, NeighborGraph& result) {
  // Bridges of each pair of components that are joined: one alone lets a part dangle, and collapse
  // in the embedding. With 1 or 2, two spheres have 962 or 780 self-intersections instead of 0.
  constexpr int bridges_per_joint = 3;
  reportFraction(report, 0.0);
  UnionFind parts = connectedComponents(result.graph);
  result.bridges = shortestBridges(points, parts, bridges_per_joint);
  if (!result.bridges.empty())
    result.graph = withEdges(result.graph, result.bridges);
  const std::vector<Bridge> bridges =
      articulationBridges(points, result.graph, bridges_per_joint - 1);
  if (bridges.empty())
    return;
  result.graph = withEdges(result.graph, bridges);
  result.bridges.insert(result.bridges.end(), bridges.begin(), bridges.end());
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
  NeighborGraph result;
  if (stars.size() == 0)
    return result;
  result.graph = std::move(agreed);
  joinWithoutPlane(points, stars, result.graph);
  repairWeak(points, stars, result.graph);
  connect(points, reportOf(execution, "graph"), result);
  return result;
}

}  // namespace spherical_param::internal
