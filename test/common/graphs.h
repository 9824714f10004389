#pragma once

#include "cloud_surfaces.h"
#include "helpers.h"
#include "local_delaunay_graph.h"
#include "openings.h"
#include "rotation_system.h"

#include <gtest/gtest.h>

/// Neighbour graphs for tests of the core's stages.
namespace spherical_param::test {

inline Stars starsOf(const Positions& points, const NeighborLists& lists,
                     const NeighborSearch& search = {}) {
  return findStars(points, {lists, search}, {});
}

inline NeighborGraph graphOf(const Positions& points, const NeighborLists& lists,
                             const NeighborSearch& search = {}) {
  const Stars stars = starsOf(points, lists, search);
  const Graph agreed = agreedGraph(points, stars, {});
  NeighborGraph result = buildLocalDelaunayGraph(points, stars, agreed, {});
  if (points.cols() > 0)
    result.stray_points = strayPoints(points, agreed, stars);
  return result;
}

inline std::vector<Index> rowOf(const Graph& graph, Index i) {
  return rowOf(graph.offsets, graph.neighbors, i);
}

/// The graph of n nodes with some edges, all of length 1.
inline Graph unitGraph(Eigen::Index n, const std::vector<std::pair<Index, Index>>& edges) {
  std::vector<std::set<Index>> rows(static_cast<std::size_t>(n));
  for (const auto& [i, j] : edges) {
    rows[static_cast<std::size_t>(i)].insert(j);
    rows[static_cast<std::size_t>(j)].insert(i);
  }
  Graph graph;
  for (const std::set<Index>& row : rows) {
    graph.neighbors.insert(graph.neighbors.end(), row.begin(), row.end());
    graph.offsets.push_back(graph.neighbors.size());
  }
  graph.lengths.assign(graph.neighbors.size(), 1.0);
  return graph;
}

/// The edges of triangles as a graph, with the lengths of the points.
inline Graph graphOfMesh(const Positions& points, const Triangles& triangles) {
  Graph graph = unitGraph(points.cols(), sidesOf(triangles));
  for (const Index v : graph.nodes())
    for (const std::size_t e : graph.entries(v))
      graph.lengths[e] = (points.col(v) - points.col(graph.neighbors[e])).norm();
  return graph;
}

/// Fraction of the edges of triangles that join nodes more than two steps apart in a graph.
inline double fractionBeyondTwoSteps(const Graph& graph, const Triangles& triangles) {
  Index beyond = 0;
  for (const auto& [a, b] : sidesOf(triangles)) {
    bool near = false;
    for (const Index middle : graph.row(a))
      near = near || middle == b || graph.row(middle).contains(b);
    beyond += near ? 0 : 1;
  }
  return static_cast<double>(beyond) / static_cast<double>(3 * triangles.cols());
}

/// The graph of the tangent Delaunay neighbours, by brute force.
inline NeighborGraph localDelaunayGraph(const Positions& points) {
  return graphOf(points, bruteForceNeighbors(points, 12), bruteForceSearch(points));
}

inline Openings openingsOf(const Positions& points, const Graph& graph) {
  const Indexed<double> spacing = nodeSpacings(graph, 1);
  RotationSystem rotation(points, graph, spacing, 1);
  return findOpenings(points, graph, spacing, rotation);
}

}  // namespace spherical_param::test
