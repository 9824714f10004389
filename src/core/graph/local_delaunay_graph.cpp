#include "local_delaunay_graph.h"

#include "component_tree.h"
#include "graph_building.h"
#include "parallel.h"
#include "progress.h"
#include "stray_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

namespace spherical_param {
namespace {

using internal::Stars;

// The experiments are on 13 models and 13 shapes of up to 60,000 points, on 25 awkward clouds (few
// points, lines of a scanner, tubes, parts, volumes) and on 35 open, partial and raw scans.

/// Bridges of each pair of components that are joined: one alone lets a part dangle, and collapse
/// in the embedding. With 1 or 2, two spheres have 962 or 780 self-intersections instead of 0.
constexpr int kBridgesPerJoint = 3;
/// Degree below which a point is repaired. Below 4 would be too generous: it brings back edges that
/// one star alone saw, across gaps; a model then has 1,203 self-intersections instead of 0. With 0,
/// a pair of elephants has 2,093,249 instead of 77,968.
constexpr std::size_t kMinDegree = 3;

Bridge edgeBetween(const Positions& points, Index i, Index j) {
  return {std::min(i, j), std::max(i, j), internal::edgeLength(points, i, j)};
}

/// Joins points without a tangent plane that only one of them finds near: their neighbourhood is
/// the same from both ends, but for the ends of the lists.
void joinWithoutPlane(const Positions& points, const Stars& stars, Graph& graph) {
  std::vector<Bridge> edges;
  for (std::size_t i = 0; i < stars.size(); ++i) {
    if (stars.kind[i].tangent_plane)
      continue;
    const auto node = static_cast<Index>(i);
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e) {
      const Index j = stars.nodes[e];
      if (!stars.kind[static_cast<std::size_t>(j)].tangent_plane && !stars.holds(j, node))
        edges.push_back(edgeBetween(points, node, j));
    }
  }
  if (!edges.empty())
    graph = internal::withEdges(graph, edges);
}

std::vector<Index> pointsOfLowDegree(const Graph& graph) {
  std::vector<Index> result;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (graph.offsets[i + 1] - graph.offsets[i] < kMinDegree)
      result.push_back(static_cast<Index>(i));
  return result;
}

/// Gives points of low degree their whole star and their nearest neighbours.
void repairWeak(const Positions& points, const Stars& stars, Graph& graph) {
  const std::vector<Index> weak = pointsOfLowDegree(graph);
  if (weak.empty())
    return;
  std::vector<Bridge> edges;
  for (const Index i : weak) {
    const auto row = static_cast<std::size_t>(i);
    for (std::size_t e = stars.begin[row]; e < stars.endOf(row); ++e)
      edges.push_back(edgeBetween(points, i, stars.nodes[e]));
    for (const Index j : stars.nearest[row])
      if (j >= 0)
        edges.push_back(edgeBetween(points, i, j));
  }
  graph = internal::withEdges(graph, edges);

  // Lists of fewer than three points leave some behind.
  const std::vector<Index> poor = pointsOfLowDegree(graph);
  if (poor.empty())
    return;
  edges.clear();
  const internal::ComponentTree tree(points);
  std::vector<Index> found;
  for (const Index i : poor) {
    found.clear();
    while (found.size() < kMinDegree) {
      internal::ComponentTree::Pair pair;
      tree.nearestExcept(i, found, pair);
      if (pair.from < 0)
        break;  // all points are found
      found.push_back(pair.from == i ? pair.to : pair.from);
      edges.push_back(edgeBetween(points, i, found.back()));
    }
  }
  graph = internal::withEdges(graph, edges);
}

/// Joins the components by edges of stars that found no agreement, the shortest first, and what is
/// left by the closest pairs.
std::vector<Bridge> joinParts(const Positions& points, const Stars& stars,
                              const std::vector<Index>& part, internal::UnionFind& parts) {
  std::vector<Bridge> edges;
  for (std::size_t i = 0; i < stars.size(); ++i)
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e)
      if (part[i] != part[static_cast<std::size_t>(stars.nodes[e])])
        edges.push_back(edgeBetween(points, static_cast<Index>(i), stars.nodes[e]));
  std::sort(edges.begin(), edges.end(), [](const Bridge& a, const Bridge& b) {
    return std::tuple(a.length, a.from, a.to) < std::tuple(b.length, b.from, b.to);
  });
  std::vector<Bridge> bridges;
  for (const Bridge& edge : edges)
    if (parts.unite(edge.from, edge.to))
      bridges.push_back(edge);
  const auto append = [&](const std::vector<Bridge>& more) {
    bridges.insert(bridges.end(), more.begin(), more.end());
  };
  append(internal::furtherBridges(points, part, bridges, kBridgesPerJoint - 1));
  append(internal::shortestBridges(points, parts, kBridgesPerJoint));
  return bridges;
}

/// Joins components, and ties each part that only one node joins to the others: it would collapse.
/// Of parts in a chain only the ends: needles have such chains, and gained nothing from more
/// rounds.
void connect(const Positions& points, const Stars& stars, const internal::FractionReport& report,
             NeighborGraph& result) {
  internal::UnionFind parts = internal::connectedComponents(result.graph);
  const std::vector<Index> part = internal::representatives(parts, stars.size());
  internal::reportFraction(report, 0.0);
  if (internal::countSets(part) > 1) {
    result.bridges = joinParts(points, stars, part, parts);
    result.graph = internal::withEdges(result.graph, result.bridges);
  }
  const std::vector<Bridge> bridges =
      internal::articulationBridges(points, result.graph, kBridgesPerJoint - 1);
  if (bridges.empty())
    return;
  result.graph = internal::withEdges(result.graph, bridges);
  result.bridges.insert(result.bridges.end(), bridges.begin(), bridges.end());
}

}  // namespace

namespace internal {

Graph agreedGraph(const Positions& points, const Stars& stars, const Execution& execution) {
  const std::size_t n = stars.size();
  const int threads = threadCount(execution.threads, n);
  const FractionReport report = reportOf(execution, "graph");
  Graph graph;
  graph.offsets.assign(n + 1, 0);
  std::vector<char> agreed(stars.nodes.size());  // not bool: written by several threads
  forEachItem(n, threads, report, [&](std::size_t, std::size_t i) {
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e)
      if (stars.holds(stars.nodes[e], static_cast<Index>(i))) {
        agreed[e] = 1;
        ++graph.offsets[i + 1];
      }
  });
  for (std::size_t i = 0; i < n; ++i)
    graph.offsets[i + 1] += graph.offsets[i];
  graph.neighbors.resize(graph.offsets[n]);
  graph.lengths.resize(graph.offsets[n]);
  forEachItem(n, threads, report, [&](std::size_t, std::size_t i) {
    std::size_t entry = graph.offsets[i];
    for (std::size_t e = stars.begin[i]; e < stars.endOf(i); ++e) {
      if (agreed[e] == 0)
        continue;
      graph.neighbors[entry] = stars.nodes[e];
      graph.lengths[entry] = edgeLength(points, static_cast<Index>(i), stars.nodes[e]);
      ++entry;
    }
  });
  return graph;
}

NeighborGraph buildLocalDelaunayGraph(const Positions& points, const Stars& stars,
                                      const Graph& agreed, StraySearch strays,
                                      const Execution& execution) {
  NeighborGraph result;
  if (stars.size() == 0)
    return result;
  if (strays == StraySearch::Yes)
    result.stray_points = strayPoints(points, agreed, stars);
  result.graph = agreed;
  joinWithoutPlane(points, stars, result.graph);
  repairWeak(points, stars, result.graph);
  connect(points, stars, reportOf(execution, "graph"), result);
  return result;
}

}  // namespace internal
}  // namespace spherical_param
