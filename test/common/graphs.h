#pragma once

#include "helpers.h"
#include "local_delaunay_graph.h"
#include "nearest_neighbor_graph.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <vector>

/// Neighbour graphs for tests of the core's stages.
namespace spherical_param::test {

/// How a graph is made.
struct GraphChoice {
  GraphMethod method = GraphMethod::LocalDelaunay;
  int k = 12;
};

/// The graph of the k nearest neighbours.
inline GraphChoice nearest(int k = 25) {
  return {GraphMethod::NearestNeighbors, k};
}

inline internal::Stars starsOf(const Positions& points, const NeighborLists& lists,
                               const NeighborSearch& search = {}, const Execution& execution = {}) {
  return internal::findStars(points, {lists, search}, execution);
}

inline NeighborGraph graphOf(const Positions& points, const NeighborLists& lists,
                             const GraphChoice& choice = {}, const NeighborSearch& search = {},
                             const Execution& execution = {}) {
  if (choice.method == GraphMethod::NearestNeighbors)
    return internal::buildNearestNeighborGraph(points, lists, choice.k);
  const internal::Stars stars = starsOf(points, lists, search, execution);
  return internal::buildLocalDelaunayGraph(points, stars,
                                           internal::agreedGraph(points, stars, execution),
                                           internal::StraySearch::Yes, execution);
}

/// The edges of triangles as a graph, with the lengths of the points.
inline Graph graphOfMesh(const Positions& points, const Triangles& triangles) {
  std::vector<std::pair<Index, Index>> entries;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      entries.emplace_back(triangles(k, t), triangles((k + 1) % 3, t));
      entries.emplace_back(triangles((k + 1) % 3, t), triangles(k, t));
    }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  Graph graph;
  graph.offsets.assign(static_cast<std::size_t>(points.cols()) + 1, 0);
  for (const auto& [i, j] : entries) {
    ++graph.offsets[static_cast<std::size_t>(i) + 1];
    graph.neighbors.push_back(j);
    graph.lengths.push_back((points.col(i) - points.col(j)).norm());
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  return graph;
}

/// Fraction of the edges of triangles that join nodes more than two steps apart in a graph.
inline double fractionBeyondTwoSteps(const Graph& graph, const Triangles& triangles) {
  const auto row = [&](Index i) {
    const auto begin = graph.neighbors.begin() +
                       static_cast<std::ptrdiff_t>(graph.offsets[static_cast<std::size_t>(i)]);
    const auto end = graph.neighbors.begin() +
                     static_cast<std::ptrdiff_t>(graph.offsets[static_cast<std::size_t>(i) + 1]);
    return std::vector<Index>(begin, end);
  };
  Index beyond = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles(k, t);
      const Index b = triangles((k + 1) % 3, t);
      bool near = false;
      for (const Index middle : row(a)) {
        const std::vector<Index> next = row(middle);
        near = near || middle == b || std::find(next.begin(), next.end(), b) != next.end();
      }
      beyond += near ? 0 : 1;
    }
  return static_cast<double>(beyond) / static_cast<double>(3 * triangles.cols());
}

/// The graph of the tangent Delaunay neighbours, by brute force.
inline NeighborGraph localDelaunayGraph(const Positions& points) {
  return graphOf(points, bruteForceNeighbors(points, 12), {}, bruteForceSearch(points));
}

}  // namespace spherical_param::test
