#include "spherical_param/mesh_topology.h"

#include "spherical_param/errors.h"

#include "corner_table.h"
#include "rows.h"
#include "union_find.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::CornerTable;

bool isDegenerate(const Eigen::Matrix<Index, 3, 1>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Disjoint sets that several threads may unite at once. The representative of a set is its lowest
/// element, hence the sets do not depend on who came first.
class ConcurrentSets {
public:
  explicit ConcurrentSets(std::size_t n) : parent_(new std::atomic<Index>[n]) {
    for (std::size_t i = 0; i < n; ++i)
      parent_[i].store(static_cast<Index>(i), std::memory_order_relaxed);
  }

  Index find(Index i) {
    for (;;) {
      const Index parent = load(i);
      const Index grandparent = load(parent);
      if (parent == grandparent)
        return parent;
      // What is no root never becomes one: an ancestor it is, though others may know a nearer one.
      at(i).store(grandparent, std::memory_order_relaxed);
      i = grandparent;
    }
  }

  void unite(Index i, Index j) {
    for (;;) {
      i = find(i);
      j = find(j);
      if (i == j)
        return;
      if (j < i)
        std::swap(i, j);
      Index root = j;
      if (at(j).compare_exchange_strong(root, i, std::memory_order_relaxed))
        return;
    }
  }

private:
  std::atomic<Index>& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  Index load(Index i) { return at(i).load(std::memory_order_relaxed); }

  std::unique_ptr<std::atomic<Index>[]> parent_;
};

/// What is found at some of the vertices, or of the triangles.
struct Findings {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t boundary_edges = 0;        ///< edges with one triangle
  std::size_t nonmanifold_edges = 0;     ///< edges with more than two triangles
  std::size_t misoriented_edges = 0;     ///< edges that both triangles traverse alike
  std::size_t degenerate_triangles = 0;  ///< triangles that name a vertex twice
  std::vector<Index> nonmanifold_vertices;
  std::vector<Index> unused_vertices;

  void operator+=(const Findings& more) {
    vertices += more.vertices;
    edges += more.edges;
    boundary_edges += more.boundary_edges;
    nonmanifold_edges += more.nonmanifold_edges;
    misoriented_edges += more.misoriented_edges;
    degenerate_triangles += more.degenerate_triangles;
    nonmanifold_vertices.insert(nonmanifold_vertices.end(), more.nonmanifold_vertices.begin(),
                                more.nonmanifold_vertices.end());
    unused_vertices.insert(unused_vertices.end(), more.unused_vertices.begin(),
                           more.unused_vertices.end());
  }
};

/// One of the two sides that a triangle has at a vertex.
struct Side {
  Index other;           ///< the vertex at its other end
  std::size_t triangle;  ///< position among the triangles of the vertex
  bool outgoing;         ///< the triangle runs from the vertex to the other end
};

/// The other two corners of the triangles around a vertex, counter-clockwise. Places that are not
/// used match no other.
template <std::size_t Size>
struct Fan {
  std::array<Index, Size> next;
  std::array<Index, Size> previous;
};

/// Whether `count` triangles are one cycle that names each neighbour once. Each is compared with
/// each: that takes less time than branches that no processor can guess.
template <std::size_t Size>
bool isCycle(const Fan<Size>& fan, std::size_t count) {
  // The triangle that ends where triangle j begins: the sum of all that do.
  std::array<Index, Size> before{};
  std::array<Index, Size> matches{};
  for (std::size_t i = 0; i < Size; ++i) {
    const Index end = fan.previous[i];
    for (std::size_t j = 0; j < Size; ++j) {
      const Index meet = -static_cast<Index>(fan.next[j] == end);  // all bits, or none
      before[j] += meet & static_cast<Index>(i);
      matches[j] -= meet;
    }
  }
  Index one_each = 1;
  std::uint32_t visited = 0;
  std::size_t j = 0;
  for (std::size_t step = 0; step < count; ++step) {
    one_each &= matches[j];
    j = static_cast<std::size_t>(before[j]) % Size;
    visited |= std::uint32_t{1} << j;
  }
  // Where one is before two others, some other is before none, and not visited.
  return one_each == 1 && j == 0 && visited == (std::uint32_t{1} << count) - 1;
}

/// Examines a vertex with any triangles: degenerate ones do not count.
void examineSides(const Triangles& triangles, const CornerTable& corners, Index v,
                  Findings& findings) {
  std::vector<Side> sides;
  std::size_t count = 0;
  corners.forEachCorner(v, [&](Index t, Index k) {
    if (isDegenerate(triangles.col(t)))
      return;
    sides.push_back({triangles((k + 1) % 3, t), count, true});
    sides.push_back({triangles((k + 2) % 3, t), count, false});
    ++count;
  });
  // Triangles with a common side belong to the same fan.
  internal::UnionFind fans(count);
  std::size_t fan_count = count;
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.other, a.triangle) < std::pair(b.other, b.triangle);
  });
  for (std::size_t begin = 0; begin < sides.size();) {
    const Index other = sides[begin].other;
    std::size_t end = begin + 1;
    for (; end < sides.size() && sides[end].other == other; ++end)
      fan_count -= fans.unite(static_cast<Index>(sides[begin].triangle),
                              static_cast<Index>(sides[end].triangle))
                       ? 1
                       : 0;
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

/// Examines a vertex whose triangles are one closed fan.
///
/// \return false: they are not, nothing was done.
template <std::size_t Size>
bool examineFan(const Triangles& triangles, const CornerTable& corners, Index v,
                Findings& findings) {
  Fan<Size> fan;
  fan.next.fill(-1);
  fan.previous.fill(-2);
  std::size_t count = 0;
  std::size_t edges = 0;
  bool sound = true;
  corners.forEachCorner(v, [&](Index t, Index k) {
    const Index a = triangles(internal::nextCorner(k), t);
    const Index b = triangles(internal::previousCorner(k), t);
    sound = sound & (a != b) & (a != v) & (b != v);
    edges += v < a ? 1 : 0;
    fan.next[count] = a;
    fan.previous[count++] = b;
  });
  if (!sound || !isCycle(fan, count))
    return false;
  findings.edges += edges;
  return true;
}

void examineVertex(const Triangles& triangles, const CornerTable& corners, Index v,
                   Findings& findings) {
  const std::size_t count = corners.countAt(v);
  if (count == 0) {
    findings.unused_vertices.push_back(v);
    return;
  }
  ++findings.vertices;
  // Most vertices have few triangles, which are compared each with each.
  if ((count <= 8 && examineFan<8>(triangles, corners, v, findings)) ||
      (count > 8 && count <= 16 && examineFan<16>(triangles, corners, v, findings)))
    return;
  examineSides(triangles, corners, v, findings);
}

void examineTriangle(const Triangles& triangles, Index t, ConcurrentSets& pieces,
                     Findings& findings) {
  if (isDegenerate(triangles.col(t)))
    ++findings.degenerate_triangles;
  pieces.unite(triangles(0, t), triangles(1, t));
  pieces.unite(triangles(1, t), triangles(2, t));
}

/// Adds up what examine(i, findings) finds for i in [0, count), in that order.
template <typename Examine>
Findings sumOf(std::size_t count, int threads, const Examine& examine) {
  return internal::sumOfBlocks(count, threads, Findings{}, [&](std::size_t begin, std::size_t end) {
    Findings findings;
    for (std::size_t i = begin; i < end; ++i)
      examine(static_cast<Index>(i), findings);
    return findings;
  });
}

}  // namespace

MeshTopology checkTopology(const Triangles& triangles, std::size_t vertex_count,
                           int requested_threads) {
  internal::checkTriangles("checkTopology", triangles, static_cast<Eigen::Index>(vertex_count));
  const int threads = internal::threadCount(requested_threads, vertex_count);

  const CornerTable corners(triangles, vertex_count, threads);
  ConcurrentSets pieces(vertex_count);
  MeshTopology result;
  result.triangles = static_cast<std::size_t>(triangles.cols());
  const Findings of_triangles = sumOf(result.triangles, threads, [&](Index t, Findings& findings) {
    examineTriangle(triangles, t, pieces, findings);
  });
  Findings all = sumOf(vertex_count, threads, [&](Index v, Findings& findings) {
    examineVertex(triangles, corners, v, findings);
  });

  result.vertices = all.vertices;
  result.edges = all.edges;
  // Unused vertices are pieces by themselves.
  for (const Index v : internal::NumberRange<Index>(0, static_cast<Index>(vertex_count)))
    result.components += pieces.find(v) == v ? 1 : 0;
  result.components -= all.unused_vertices.size();

  result.closed = triangles.cols() > 0 && all.boundary_edges == 0;
  result.edge_manifold = all.nonmanifold_edges == 0 && of_triangles.degenerate_triangles == 0;
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
