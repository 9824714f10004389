#include "open_mesh.h"

#include "helpers.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

TEST(OpenMesh, PutsAVertexIntoTheTriangleThatCoversIt) {
  // A pyramid on each side of a square. All around the upper tip is open, and it lies in a triangle
  // of the lower side, to the last bit: whatever joins it to a side of the square would intersect
  // that one.
  const Positions points = positionsOf(
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0.25, 0.25, -0.25}, {0, 0, -0.5}});
  Triangles triangles(3, 8);
  for (Index i = 0; i < 4; ++i) {
    triangles.col(2 * i) << i, (i + 1) % 4, 4;
    triangles.col(2 * i + 1) << (i + 1) % 4, i, 5;
  }
  Graph graph;  // without edges
  graph.offsets.assign(7, 0);
  Openings openings;
  openings.spacing.assign(6, 0.6);
  openings.openings.emplace_back().loop = {0, 1, 2, 3, 4};
  SphereMesh mesh(triangles, 6);
  openMesh(points, OpenPlaces(points, graph, openings), mesh);
  const Triangles surface = mesh.surfaceTriangles();
  EXPECT_EQ(surface.cols(), 6);
  EXPECT_TRUE(findSelfIntersections(points, surface).empty());
  const MeshTopology topology = checkTopology(surface, 6);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.unused_vertices.empty());
}

}  // namespace
}  // namespace spherical_param::test
