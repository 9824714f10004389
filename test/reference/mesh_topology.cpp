#include "reference/mesh_topology.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <vector>

namespace spherical_param::reference {
namespace {

/// The number of pieces that triangles are in, over shared vertices.
std::size_t countPieces(const Triangles& triangles, Index n) {
  std::vector<std::vector<Index>> triangles_at(static_cast<std::size_t>(n));
  for (Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      triangles_at[static_cast<std::size_t>(triangles(k, t))].push_back(t);
  std::vector<bool> seen(static_cast<std::size_t>(triangles.cols()), false);
  std::size_t pieces = 0;
  std::vector<Index> open;
  for (Index first = 0; first < triangles.cols(); ++first) {
    if (seen[static_cast<std::size_t>(first)])
      continue;
    ++pieces;
    seen[static_cast<std::size_t>(first)] = true;
    open.assign(1, first);
    while (!open.empty()) {
      const Index t = open.back();
      open.pop_back();
      for (int k = 0; k < 3; ++k)
        for (const Index other : triangles_at[static_cast<std::size_t>(triangles(k, t))])
          if (!seen[static_cast<std::size_t>(other)]) {
            seen[static_cast<std::size_t>(other)] = true;
            open.push_back(other);
          }
    }
  }
  return pieces;
}

/// The number of fans that the triangles around a vertex are; a link is the side opposite to it.
std::size_t countFans(const std::vector<std::array<Index, 2>>& links) {
  std::vector<std::set<Index>> fans;
  for (const auto& link : links) {
    std::set<Index> fan(link.begin(), link.end());
    for (auto other = fans.begin(); other != fans.end();) {
      if (other->count(link[0]) + other->count(link[1]) == 0) {
        ++other;
      } else {
        fan.insert(other->begin(), other->end());
        other = fans.erase(other);
      }
    }
    fans.push_back(fan);
  }
  return fans.size();
}

}  // namespace

MeshTopology topologyOf(const Triangles& triangles, Index n) {
  MeshTopology result;
  result.closed = triangles.cols() > 0;
  result.edge_manifold = result.oriented = true;
  result.triangles = static_cast<std::size_t>(triangles.cols());
  std::map<std::array<Index, 2>, std::vector<bool>> edges;  // whether a side runs upwards
  std::vector<std::vector<std::array<Index, 2>>> links(static_cast<std::size_t>(n));
  std::vector<bool> used(static_cast<std::size_t>(n), false);
  for (Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Matrix<Index, 3, 1> corners = triangles.col(t);
    for (int k = 0; k < 3; ++k)
      used[static_cast<std::size_t>(corners[k])] = true;
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      result.edge_manifold = false;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const Index a = corners[k];
      const Index b = corners[(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}].push_back(a < b);
      links[static_cast<std::size_t>(a)].push_back({b, corners[(k + 2) % 3]});
    }
  }
  for (const auto& each : edges) {
    const std::vector<bool>& sides = each.second;
    result.closed = result.closed && sides.size() > 1;
    result.edge_manifold = result.edge_manifold && sides.size() <= 2;
    result.oriented =
        result.oriented && (sides.size() == 1 || (sides.size() == 2 && sides[0] != sides[1]));
  }
  for (Index v = 0; v < n; ++v) {
    if (!used[static_cast<std::size_t>(v)]) {
      result.unused_vertices.push_back(v);
      continue;
    }
    ++result.vertices;
    if (countFans(links[static_cast<std::size_t>(v)]) > 1)
      result.nonmanifold_vertices.push_back(v);
  }
  result.edges = edges.size();
  result.components = countPieces(triangles, n);
  result.euler_characteristic = static_cast<long long>(result.vertices) -
                                static_cast<long long>(result.edges) +
                                static_cast<long long>(result.triangles);
  return result;
}

}  // namespace spherical_param::reference
