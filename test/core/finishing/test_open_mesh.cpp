#include "open_mesh.h"

#include "helpers.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

/// Opened within loops of a surface, of some point spacing; the graph has no edges.
Triangles opened(const Positions& points, const Triangles& triangles, double spacing,
                 const std::vector<Index>& loop) {
  Graph graph;
  graph.offsets.assign(columnCount(points) + 1, 0);
  Openings openings;
  openings.spacing.assign(columnCount(points), spacing);
  openings.openings.emplace_back().loop = loop;
  SphereMesh mesh(triangles, columnCount(points));
  openMesh(points, OpenPlaces(points, graph, openings), mesh);
  return mesh.surfaceTriangles();
}

/// A double pyramid over a ring of n points at z = 0, with tips n and n + 1.
struct DoublePyramid {
  explicit DoublePyramid(Index n) : points(3, n + 2), triangles(3, 2 * n) {
    for (Index i = 0; i < n; ++i) {
      points.col(i) = onCircle(2.0 * kPi * i / n);
      triangles.col(2 * i) << i, (i + 1) % n, n;
      triangles.col(2 * i + 1) << (i + 1) % n, i, n + 1;
    }
    points.col(n) << 0.0, 0.0, 0.5;
    points.col(n + 1) << 0.0, 0.0, -0.5;
  }

  Positions points;
  Triangles triangles;
};

TEST(OpenMesh, PutsAVertexIntoTheTriangleThatCoversIt) {
  // All around the upper tip is open, and it lies in a triangle of the lower side, to the last bit:
  // whatever joins it to an edge of the ring would intersect that one.
  DoublePyramid pyramid(4);
  pyramid.points.leftCols(4) << 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0;
  pyramid.points.col(4) << 0.25, 0.25, -0.25;
  const Triangles surface = opened(pyramid.points, pyramid.triangles, 0.6, {0, 1, 2, 3, 4});
  EXPECT_EQ(surface.cols(), 6);
  EXPECT_TRUE(findSelfIntersections(pyramid.points, surface).empty());
  const MeshTopology topology = checkTopology(surface, 6);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.unused_vertices.empty());
}

// A flat disc of 2,340 triangles, and 60 vertices above it, to the last bit in its plane: all their
// triangles are open, and whatever joins them to the rim crosses many.
TEST(OpenMesh, PutsManyVerticesIntoALargeFlatSurface) {
  constexpr Index n = 60;
  constexpr Index rings = 20;
  constexpr Index center = n * rings;
  constexpr Index tip = center + 1;
  Positions points = Positions::Zero(3, tip + n);
  std::vector<std::array<Index, 3>> all;
  std::vector<Index> loop;
  for (Index i = 0; i < n; ++i) {
    const Index next = (i + 1) % n;
    for (Index ring = 0; ring < rings; ++ring) {
      points.col(ring * n + i) =
          onCircle(2.0 * kPi * i / n, 1.0 - static_cast<double>(ring) / rings);
      if (ring + 1 < rings) {
        all.push_back({ring * n + i, (ring + 1) * n + i, ring * n + next});
        all.push_back({ring * n + next, (ring + 1) * n + i, (ring + 1) * n + next});
      }
    }
    all.push_back({center - n + i, center, center - n + next});
    // Above: around the tip, and a vertex in each triangle but one.
    const Index v = tip + i;
    points.col(v) = onCircle(2.4 * i, 0.3 + 0.6 * i / n);  // where triangles are not thin
    loop.push_back(i);
    if (i == 0) {
      all.push_back({i, next, tip});
      continue;
    }
    all.push_back({i, next, v});
    all.push_back({next, tip, v});
    all.push_back({tip, i, v});
  }
  for (Index v = tip; v < tip + n; ++v)
    loop.push_back(v);
  const Triangles triangles =
      Eigen::Map<const Triangles>(all[0].data(), 3, static_cast<Eigen::Index>(all.size()));
  const Triangles surface = opened(points, triangles, 1e-3, loop);
  const MeshTopology topology = checkTopology(surface, columnCount(points));
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.unused_vertices.empty());
  // A few vertices find no such triangle, or cannot be taken out: theirs cross many.
  std::set<Index> crossing;
  for (const auto& [t, u] : findSelfIntersections(points, surface))
    crossing.insert(surface.col(t).maxCoeff() > center ? t : u);
  EXPECT_LT(crossing.size(), 6U);
}

TEST(OpenMesh, TrianglesWithoutALoopAreOfTheSurface) {
  // The edges from the upper tip to 0 and to 4 are long; only the first is in a loop.
  const DoublePyramid pyramid(8);
  Openings openings;
  openings.spacing.assign(10, 1.0);
  for (const Index v : {0, 4, 8})
    openings.spacing[v] = 0.3;
  openings.openings.emplace_back().loop = {0, 1, 8};
  // All are near each other.
  Graph graph;
  for (Index v = 0; v < 10; ++v) {
    for (Index w = 0; w < 10; ++w)
      if (v != w)
        graph.neighbors.push_back(w);
    graph.endRow();
  }
  OpenPlaces places(pyramid.points, graph, openings);
  const SphereMesh mesh(pyramid.triangles, 10);
  const std::vector<Index> found = trianglesWithoutLoop(mesh, places);
  EXPECT_EQ(std::set<Index>(found.begin(), found.end()), (std::set<Index>{6, 8}));
  EXPECT_TRUE(places.isOpen(4, 5, 8));
  places.close({3, 4, 5, 8});
  EXPECT_FALSE(places.isOpen(4, 5, 8));
  EXPECT_TRUE(places.isOpen(0, 1, 8));
  EXPECT_TRUE(trianglesWithoutLoop(mesh, places).empty());
}

}  // namespace
}  // namespace spherical_param::test
