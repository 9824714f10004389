#include "face_mesh.h"

#include "graph_building.h"
#include "graphs.h"
#include "handle_shapes.h"
#include "open_shapes.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

std::optional<SphereMesh> facesOf(const Positions& points, const Graph& graph) {
  return meshFaces(points, graph, RotationSystem(points, graph, nodeSpacings(graph, 1), 1));
}

/// The mesh of the faces of a graph without handles, and of the other nodes.
std::optional<Triangles> meshOf(const Positions& points, const Graph& graph) {
  std::optional<SphereMesh> faces = facesOf(points, graph);
  if (faces && faces->genus() > 0)
    faces = withoutHandles(points, graph, *std::move(faces));
  if (!faces)
    return std::nullopt;
  return withAllNodes(points, graph, *faces).triangles();
}

std::set<std::pair<Index, Index>> edgesOf(const Triangles& triangles) {
  std::set<std::pair<Index, Index>> edges;
  for (const auto& [v, w] : sidesOf(triangles))
    edges.insert(std::minmax(v, w));
  return edges;
}

/// Number of edges of a mesh that another one lacks.
std::size_t countLost(const Triangles& before, const Triangles& after) {
  const auto left = edgesOf(after);
  std::size_t lost = 0;
  for (const auto& edge : edgesOf(before))
    lost += left.count(edge) == 0 ? 1 : 0;
  return lost;
}

TEST(FaceMesh, WithoutAnUnwantedHandleKeepsTheRest) {
  const Positions torus = torusCloud(40, 16, 1.0, 0.4);
  const Graph graph = localDelaunayGraph(torus).graph;
  const auto whole = facesOf(torus, graph);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->genus(), 1U);
  EXPECT_TRUE(isSurfaceOverAll(whole->triangles(), static_cast<Index>(torus.cols()), 1));
  const auto cut = meshOf(torus, graph);
  ASSERT_TRUE(cut);
  EXPECT_TRUE(isSphereOverAll(*cut, static_cast<Index>(torus.cols())));
  // It is cut across the tube, of 16 points, or along it, of 40.
  EXPECT_LE(countLost(whole->triangles(), *cut), 4U * 40U);
}

TEST(FaceMesh, APieceThatFindsNoFreeTriangleIsNodesWithoutFaces) {
  // Eight spheres hang on one vertex of another one, which has triangles for a few.
  constexpr Index n = 30;
  constexpr Index spheres = 9;
  const Positions sphere = spiralSphere(n);
  const Triangles hull = triangulateSphere(sphere);
  Positions points(3, spheres * n);
  Triangles triangles(3, spheres * hull.cols());
  std::vector<Bridge> bridges;
  for (Index i = 0; i < spheres; ++i) {
    points.middleCols(i * n, n) = movedTo(3.0 * i, sphere);
    triangles.middleCols(i * hull.cols(), hull.cols()) = hull.array() + i * n;
    if (i > 0)
      bridges.push_back({0, i * n, 3.0 * i});
  }
  const auto mesh = meshOf(points, withEdges(graphOfMesh(points, triangles), bridges));
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(isSphereOverAll(*mesh, spheres * n));
}

TEST(FaceMesh, TrianglesThatFillALoopAreOpen) {
  // The loop around a hole has more than 20 points.
  const Positions points = sphereWithHoles(1000, 1, 0.4);
  const auto mesh = facesOf(points, localDelaunayGraph(points).graph);
  ASSERT_TRUE(mesh);
  Index fillings = 0;
  for (Index t = 0; t < mesh->size(); ++t)
    if (mesh->isOpen(t)) {
      ++fillings;
      for (const Index v : mesh->vertices(t))
        EXPECT_LT((points.col(v) - spiralSphere(1).col(0)).norm(), 0.6);
    }
  EXPECT_GT(fillings, 15);
}

TEST(FaceMesh, NeedsMoreFacesThanOneTriangle) {
  // A line, and a triangle with a tail: its two sides would be a closed mesh of 3 vertices.
  const Positions points = positionsOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0.1}, {3, 0, 0.3}});
  EXPECT_FALSE(facesOf(points, unitGraph(5, {{0, 1}, {1, 2}, {2, 3}, {3, 4}})));
  EXPECT_FALSE(facesOf(points, unitGraph(5, {{0, 1}, {1, 2}, {0, 2}, {1, 3}, {3, 4}})));
}

}  // namespace
}  // namespace spherical_param::test
