#include "spherical_param/mesh_topology.h"

#include "spherical_param/errors.h"

#include "corner_table.h"
#include "rows.h"
#include "union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::CornerTable;

bool isDegenerate(const Eigen::Matrix<Index, 3, 1>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// What is found at some of the vertices, or of the triangles.
struct Findings {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t boundary_edges = 0;     ///< edges with one triangle
  std::size_t nonmanifold_edges = 0;  ///< edges with more than two triangles
  std::size_t misoriented_edges = 0;  ///< edges that both triangles traverse alike
  std::vector<Index> nonmanifold_vertices;
  std::vector<Index> unused_vertices;

  void operator+=(const Findings& more) {
    vertices += more.vertices;
    edges += more.edges;
    boundary_edges += more.boundary_edges;
    nonmanifold_edges += more.nonmanifold_edges;
    misoriented_edges += more.misoriented_edges;
    nonmanifold_vertices.insert(nonmanifold_vertices.end(), more.nonmanifold_vertices.begin(),
                                more.nonmanifold_vertices.end());
    unused_vertices.insert(unused_vertices.end(), more.unused_vertices.begin(),
                           more.unused_vertices.end());
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
        ++findings.boundary_edges;
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

/// Recognises vertices whose triangles are one closed fan, as nearly all are: those of a manifold.
class Fan {
public:
  explicit Fan(std::size_t vertex_count) : ending_at_(vertex_count, 0) {}

  /// Counts the edges of such a vertex to higher ones. False: it is none, nothing was done.
  bool examine(const Triangles& triangles, const CornerTable& corners, Index v,
               Findings& findings) {
    next_.clear();
    previous_.clear();
    std::size_t edges = 0;
    bool is_sound = true;
    corners.forEachCorner(v, [&](Index t, Index k) {
      const Index a = triangles(internal::nextCorner(k), t);
      const Index b = triangles(internal::previousCorner(k), t);
      is_sound = is_sound && a != b && a != v && b != v;
      edges += v < a ? 1 : 0;
      ending_at_[b] = next_.count();
      next_.push_back(a);
      previous_.push_back(b);
    });
    if (!is_sound || !isCycle())
      return false;
    findings.edges += edges;
    return true;
  }

private:
  /// Whether the first triangle is reached again only after all others.
  bool isCycle() const {
    Index triangle = 0;
    for (Index steps = 1; steps <= next_.count(); ++steps) {
      const Index vertex = next_[triangle];
      triangle = ending_at_[vertex];
      if (triangle >= next_.count() || previous_[triangle] != vertex)
        return false;  // of an earlier fan
      if (triangle == 0)
        return steps == next_.count();
    }
    return false;
  }

  internal::Indexed<Index> ending_at_;  ///< for each vertex, the last triangle that ends there
  internal::Indexed<Index> next_;       ///< the other corners of the triangles
  internal::Indexed<Index> previous_;
};

void examineVertex(const Triangles& triangles, const CornerTable& corners, Index v, Fan& fan,
                   Findings& findings) {
  if (corners.countAt(v) == 0) {
    findings.unused_vertices.push_back(v);
    return;
  }
  ++findings.vertices;
  if (!fan.examine(triangles, corners, v, findings))
    examineSides(triangles, corners, v, findings);
}

}  // namespace

MeshTopology checkTopology(const Triangles& triangles, std::size_t vertex_count,
                           int requested_threads) {
  internal::checkTriangles("checkTopology", triangles, static_cast<Eigen::Index>(vertex_count));
  const int threads = internal::threadCount(requested_threads, vertex_count);

  const CornerTable corners(triangles, vertex_count, threads);
  std::vector<Fan> fans(static_cast<std::size_t>(threads), Fan(vertex_count));
  Findings all =
      internal::accumulate(vertex_count, threads, Findings{}, [&](Index v, Findings& findings) {
        examineVertex(triangles, corners, v, fans[internal::threadNumber()], findings);
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

  result.closed = triangles.cols() > 0 && all.boundary_edges == 0;
  result.edge_manifold = all.nonmanifold_edges == 0 && degenerate_triangles == 0;
  result.vertex_manifold = all.nonmanifold_vertices.empty();
  result.oriented = all.misoriented_edges == 0 && all.nonmanifold_edges == 0;
  result.nonmanifold_vertices = std::move(all.nonmanifold_vertices);
  result.unused_vertices = std::move(all.unused_vertices);
  result.euler_characteristic = static_cast<long long>(result.vertices) -
                                static_cast<long long>(result.edges) + triangles.cols();
  if (result.closed && result.manifold() && result.oriented)
    result.genus = static_cast<long long>(result.components) - result.euler_characteristic / 2;
  return result;
}

double signedVolume(const Positions& points, const Triangles& triangles) {
  if (triangles.cols() == 0)
    return 0.0;
  internal::checkTriangles("signedVolume", triangles, points.cols());
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
  internal::checkTriangles("surfaceArea", triangles, points.cols());
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    sum += internal::areaNormal(points, triangles, t).norm();
  return sum / 2.0;
}

void flipOrientation(Triangles& triangles) {
  if (triangles.cols() > 0)  // else there is no row to point at
    triangles.row(1).swap(triangles.row(2));
}

}  // namespace spherical_param
