#include "local_delaunay_graph.h"

#include "component_tree.h"
#include "graph_building.h"
#include "progress.h"

#include <optional>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// Edges between points without a tangent plane that only one of the two stars has. Gabriel
/// neighbours are mutual; only the lists may end before one of them.
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
  // Degree below which a point is repaired. A higher one would bring back edges across gaps, which
  // one star alone has.
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
  // Bridges between two components that are joined. With fewer, a part would dangle and collapse in
  // the embedding.
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
  // Parts that hang by one node would collapse, too. Of parts in a chain, as in a needle, only the
  // ends get bridges: more gain nothing.
  const std::vector<Bridge> ties = articulationBridges(points, graph, bridges_per_joint - 1);
  add(ties);
  result.bridges.insert(result.bridges.end(), ties.begin(), ties.end());
  return result;
}

}  // namespace spherical_param::internal
