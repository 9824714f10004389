#include "spherical_param/mesh_topology.h"

#include "spherical_param/mesh_measures.h"

#include "corner_table.h"
#include "indexed.h"
#include "rows.h"
#include "union_find.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::CornerTable;

bool isDegenerate(const Eigen::Matrix<Index, 3, 1>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// What is found at some of the vertices.
struct Findings {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t nonmanifold_edges = 0;                 ///< edges with more than two triangles
  std::size_t misoriented_edges = 0;                 ///< edges that two triangles run along alike
  std::vector<std::array<Index, 2>> boundary_edges;  ///< edges with one triangle
  std::vector<Index> nonmanifold_vertices;
  std::vector<Index> unused_vertices;

  void operator+=(const Findings& more) {
    vertices += more.vertices;
    edges += more.edges;
    nonmanifold_edges += more.nonmanifold_edges;
    misoriented_edges += more.misoriented_edges;
    const auto append = [](const auto& from, auto& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(more.boundary_edges, boundary_edges);
    append(more.nonmanifold_vertices, nonmanifold_vertices);
    append(more.unused_vertices, unused_vertices);
  }
};

/// One of the two sides that a triangle has at a vertex.
struct Side {
  Index other;     ///< the vertex at its other end
  Index triangle;  ///< position among the triangles of the vertex
  bool outgoing;   ///< the triangle runs from the vertex to the other end
};

/// Examines a vertex with any triangles: degenerate ones do not count.
void examineSides(const Triangles& triangles, const CornerTable& corners, Index v,
                  Findings& findings) {
  std::vector<Side> sides;
  Index count = 0;
  corners.forEachCorner(v, [&](Index t, Index k) {
    if (isDegenerate(triangles.col(t)))
      return;
    sides.push_back({triangles((k + 1) % 3, t), count, true});
    sides.push_back({triangles((k + 2) % 3, t), count, false});
    ++count;
  });
  // Triangles with a common side belong to the same fan.
  internal::UnionFind fans(static_cast<std::size_t>(count));
  Index fan_count = count;
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.other, a.triangle) < std::pair(b.other, b.triangle);
  });
  for (std::size_t begin = 0; begin < sides.size();) {
    const Index other = sides[begin].other;
    std::size_t end = begin + 1;
    for (; end < sides.size() && sides[end].other == other; ++end)
      fan_count -= fans.unite(sides[begin].triangle, sides[end].triangle) ? 1 : 0;
    // Each edge counts at the lower of its ends.
    if (v < other) {
      ++findings.edges;
      if (end - begin == 1)
        findings.boundary_edges.push_back({v, other});
      else if (end - begin > 2)
        ++findings.nonmanifold_edges;
      else if (sides[begin].outgoing == sides[begin + 1].outgoing)
        ++findings.misoriented_edges;
    }
    begin = end;
  }
  if (fan_count > 1)
    findings.nonmanifold_vertices.push_back(v);
}

/// Whether the triangles around a vertex are one closed fan, as in a closed manifold. Also false if
/// there are too many triangles for this quick test.
bool isClosedFan(const Triangles& triangles, const CornerTable& corners, Index v) {
  constexpr std::size_t most = 32;
  const std::size_t count = corners.countAt(v);
  if (count > most)
    return false;
  std::array<std::array<Index, 2>, most> sides;  // opposite to v
  const auto end = sides.begin() + static_cast<std::ptrdiff_t>(count);
  auto side = sides.begin();
  bool is_sound = true;
  corners.forEachCorner(v, [&](Index t, Index k) {
    is_sound = is_sound && !isDegenerate(triangles.col(t));
    *side++ = {triangles(internal::nextCorner(k), t), triangles(internal::previousCorner(k), t)};
  });
  // Each side ends where another one begins that was not reached before; the last ends at the
  // first.
  for (side = sides.begin(); is_sound && side != end; ++side) {
    auto next = end;  // found without a branch, which would be mispredicted
    for (auto other = end; other != sides.begin();) {
      --other;
      next = (*other)[0] == (*side)[1] ? other : next;
    }
    is_sound = side + 1 == end ? next == sides.begin() : next > side && next != end;
    if (is_sound && side + 1 != end)
      std::swap(*(side + 1), *next);
  }
  return is_sound;
}

void examineVertex(const Triangles& triangles, const CornerTable& corners, Index v,
                   Findings& findings) {
  if (corners.countAt(v) == 0) {
    findings.unused_vertices.push_back(v);
    return;
  }
  ++findings.vertices;
  if (!isClosedFan(triangles, corners, v)) {
    examineSides(triangles, corners, v, findings);
    return;
  }
  // Each edge counts at the lower of its ends.
  corners.forEachCorner(v, [&](Index t, Index k) {
    findings.edges += v < triangles(internal::nextCorner(k), t) ? 1 : 0;
  });
}

/// Number of connected components of a set of edges.
std::size_t countComponents(const std::vector<std::array<Index, 2>>& edges, std::size_t vertices) {
  if (edges.empty())
    return 0;
  internal::UnionFind sets(vertices);
  internal::IndexSet ends(vertices);
  std::size_t count = 0;
  for (const auto& [v, w] : edges) {
    count += (ends.insert(v) ? 1U : 0U) + (ends.insert(w) ? 1U : 0U);
    count -= sets.unite(v, w) ? 1U : 0U;
  }
  return count;
}

}  // namespace

MeshTopology checkTopology(const Triangles& triangles, std::size_t vertex_count,
                           int requested_threads) {
  internal::checkTriangles("checkTopology", triangles, static_cast<Eigen::Index>(vertex_count));
  const int threads = internal::threadCount(requested_threads, vertex_count);

  const CornerTable corners(triangles, vertex_count, threads);
  Findings all =
      internal::accumulate(vertex_count, threads, Findings{}, [&](Index v, Findings& findings) {
        examineVertex(triangles, corners, v, findings);
      });
  MeshTopology result;
  result.triangles = internal::columnCount(triangles);
  result.vertices = all.vertices;
  result.edges = all.edges;
  // Unused vertices are pieces by themselves.
  result.components = vertex_count;
  std::size_t degenerate_triangles = 0;
  internal::UnionFind pieces(vertex_count);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    degenerate_triangles += isDegenerate(triangles.col(t)) ? 1 : 0;
    for (const Eigen::Index k : {1, 2})
      result.components -= pieces.unite(triangles(0, t), triangles(k, t)) ? 1 : 0;
  }
  result.components -= all.unused_vertices.size();

  result.closed = triangles.cols() > 0 && all.boundary_edges.empty();
  result.edge_manifold = all.nonmanifold_edges == 0 && degenerate_triangles == 0;
  result.vertex_manifold = all.nonmanifold_vertices.empty();
  result.oriented = all.misoriented_edges == 0 && all.nonmanifold_edges == 0;
  result.nonmanifold_vertices = std::move(all.nonmanifold_vertices);
  result.unused_vertices = std::move(all.unused_vertices);
  result.euler_characteristic = static_cast<long long>(result.vertices) -
                                static_cast<long long>(result.edges) + triangles.cols();
  result.boundary_loops = countComponents(all.boundary_edges, vertex_count);
  if (triangles.cols() > 0 && result.manifold() && result.oriented)
    result.genus =
        static_cast<long long>(result.components) -
        (result.euler_characteristic + static_cast<long long>(result.boundary_loops)) / 2;
  return result;
}

double signedVolume(const Positions& points, const Triangles& triangles) {
  return measureMesh(points, triangles).volume;
}

double surfaceArea(const Positions& points, const Triangles& triangles) {
  return measureMesh(points, triangles).area;
}

void flipOrientation(Triangles& triangles) {
  if (triangles.cols() > 0)  // else there is no row to point at
    triangles.row(1).swap(triangles.row(2));
}

}  // namespace spherical_param
