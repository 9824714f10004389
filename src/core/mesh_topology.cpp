#include "spherical_param/mesh_topology.h"

#include "spherical_param/errors.h"

#include "core/union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <string>
#include <utility>

namespace spherical_param {
namespace {

/// A triangle's side, stored with the lower of its two vertices.
struct Side {
  Index other;     ///< the higher vertex
  Index triangle;  ///< the triangle
  bool forward;    ///< the triangle runs from the lower to the higher vertex
};

bool isDegenerate(const Eigen::Matrix<Index, 3, 1>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Position of vertex v in triangle t, as an index of corners 3 * t + {0, 1, 2}.
Index cornerOf(const Triangles& triangles, Index t, Index v) {
  Index corner = 0;
  while (triangles(corner, t) != v)
    ++corner;
  return 3 * t + corner;
}

/// All sides, grouped by lower vertex and sorted by higher vertex within a group.
struct SideTable {
  std::vector<std::size_t> offsets;
  std::vector<Side> sides;
};

SideTable collectSides(const Triangles& triangles, std::size_t vertex_count) {
  SideTable table;
  table.offsets.assign(vertex_count + 1, 0);
  const auto for_each_side = [&](auto&& visit) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      if (isDegenerate(triangles.col(t)))
        continue;
      for (int k = 0; k < 3; ++k)
        visit(triangles(k, t), triangles((k + 1) % 3, t), static_cast<Index>(t));
    }
  };
  for_each_side([&](Index from, Index to, Index) {
    ++table.offsets[static_cast<std::size_t>(std::min(from, to)) + 1];
  });
  for (std::size_t v = 0; v < vertex_count; ++v)
    table.offsets[v + 1] += table.offsets[v];
  table.sides.resize(table.offsets[vertex_count]);
  std::vector<std::size_t> next(table.offsets.begin(), table.offsets.end() - 1);
  for_each_side([&](Index from, Index to, Index t) {
    table.sides[next[static_cast<std::size_t>(std::min(from, to))]++] = {std::max(from, to), t,
                                                                         from < to};
  });
  for (std::size_t v = 0; v < vertex_count; ++v)
    std::sort(table.sides.begin() + static_cast<std::ptrdiff_t>(table.offsets[v]),
              table.sides.begin() + static_cast<std::ptrdiff_t>(table.offsets[v + 1]),
              [](const Side& a, const Side& b) {
                return std::pair(a.other, a.triangle) < std::pair(b.other, b.triangle);
              });
  return table;
}

}  // namespace

MeshTopology checkTopology(const Triangles& triangles, std::size_t vertex_count) {
  const auto m = static_cast<Index>(triangles.cols());
  for (Index t = 0; t < m; ++t)
    for (int k = 0; k < 3; ++k)
      if (triangles(k, t) < 0 || static_cast<std::size_t>(triangles(k, t)) >= vertex_count)
        throw InvalidInput("checkTopology: triangle " + std::to_string(t) + " names vertex " +
                           std::to_string(triangles(k, t)) + " of " + std::to_string(vertex_count) +
                           "; indices start at 0");

  MeshTopology result;
  result.triangles = static_cast<std::size_t>(m);
  TopologyFaults& faults = result.faults;
  internal::UnionFind pieces(vertex_count);
  std::vector<bool> used(vertex_count, false);
  for (Index t = 0; t < m; ++t) {
    if (isDegenerate(triangles.col(t)))
      faults.degenerate_triangles.push_back(t);
    for (int k = 0; k < 3; ++k) {
      used[static_cast<std::size_t>(triangles(k, t))] = true;
      pieces.unite(triangles(k, t), triangles((k + 1) % 3, t));
    }
  }

  // Corners of two triangles at the ends of a common side belong to the same fan.
  internal::UnionFind fans(3 * static_cast<std::size_t>(m));
  const SideTable table = collectSides(triangles, vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto low = static_cast<Index>(v);
    for (std::size_t begin = table.offsets[v]; begin < table.offsets[v + 1];) {
      const Index high = table.sides[begin].other;
      std::size_t end = begin + 1;
      while (end < table.offsets[v + 1] && table.sides[end].other == high)
        ++end;
      ++result.edges;
      if (end - begin == 1)
        faults.boundary_edges.push_back({low, high});
      else if (end - begin > 2)
        faults.nonmanifold_edges.push_back({low, high});
      else if (table.sides[begin].forward == table.sides[begin + 1].forward)
        faults.misoriented_edges.push_back({low, high});
      for (std::size_t s = begin + 1; s < end; ++s)
        for (const Index end_vertex : {low, high})
          fans.unite(cornerOf(triangles, table.sides[begin].triangle, end_vertex),
                     cornerOf(triangles, table.sides[s].triangle, end_vertex));
      begin = end;
    }
  }

  std::vector<Index> fan_of_vertex(vertex_count, -1);
  std::vector<bool> several_fans(vertex_count, false);
  for (Index t = 0; t < m; ++t) {
    if (isDegenerate(triangles.col(t)))
      continue;
    for (Index k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangles(k, t));
      const Index fan = fans.find(3 * t + k);
      if (fan_of_vertex[v] < 0)
        fan_of_vertex[v] = fan;
      else if (fan_of_vertex[v] != fan)
        several_fans[v] = true;
    }
  }
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (!used[v])
      faults.unused_vertices.push_back(static_cast<Index>(v));
    else if (pieces.find(static_cast<Index>(v)) == static_cast<Index>(v))
      ++result.components;
    if (several_fans[v])
      faults.nonmanifold_vertices.push_back(static_cast<Index>(v));
    result.vertices += used[v] ? 1 : 0;
  }

  result.closed = m > 0 && faults.boundary_edges.empty();
  result.edge_manifold = faults.nonmanifold_edges.empty() && faults.degenerate_triangles.empty();
  result.vertex_manifold = faults.nonmanifold_vertices.empty();
  result.oriented = faults.misoriented_edges.empty() && faults.nonmanifold_edges.empty();
  result.euler_characteristic = static_cast<long long>(result.vertices) -
                                static_cast<long long>(result.edges) + static_cast<long long>(m);
  if (result.closed && result.manifold() && result.oriented)
    result.genus = static_cast<long long>(result.components) - result.euler_characteristic / 2;
  return result;
}

double signedVolume(const Positions& points, const Triangles& triangles) {
  if (triangles.cols() == 0)
    return 0.0;
  // About a point of the mesh, so that a far origin costs no digits.
  const Eigen::Vector3d origin = points.col(triangles(0, 0));
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t)) - origin;
    const Eigen::Vector3d b = points.col(triangles(1, t)) - origin;
    const Eigen::Vector3d c = points.col(triangles(2, t)) - origin;
    sum += a.dot(b.cross(c));
  }
  return sum / 6.0;
}

double surfaceArea(const Positions& points, const Triangles& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d ab = points.col(triangles(1, t)) - a;
    const Eigen::Vector3d ac = points.col(triangles(2, t)) - a;
    sum += ab.cross(ac).norm();
  }
  return sum / 2.0;
}

void flipOrientation(Triangles& triangles) {
  triangles.row(1).swap(triangles.row(2));
}

}  // namespace spherical_param
