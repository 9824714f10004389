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
