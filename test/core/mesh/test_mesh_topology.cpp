#include "spherical_param/mesh_topology.h"

#include "helpers.h"
#include "reference/mesh_topology.h"
#include "triangle_lists.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace spherical_param {
namespace {

using test::tetrahedron;
using test::torusTriangles;
using test::trianglesOf;

Triangles joined(const Triangles& a, const Triangles& b) {
  Triangles result(3, a.cols() + b.cols());
  result << a, b;
  return result;
}

TEST(MeshTopology, GenusAddsUpOverComponents) {
  const auto expect = [](const Triangles& triangles, std::size_t n, int components, int genus) {
    const MeshTopology topology = checkTopology(triangles, n);
    EXPECT_TRUE(topology.closed && topology.manifold() && topology.oriented);
    EXPECT_EQ(topology.components, static_cast<std::size_t>(components));
    EXPECT_EQ(topology.euler_characteristic, 2 * (components - genus));
    EXPECT_EQ(topology.genus, genus);
    EXPECT_EQ(topology.isSphere(), components == 1 && genus == 0);
  };
  const Triangles torus = torusTriangles(5, 5);
  expect(tetrahedron(), 4, 1, 0);
  expect(torus, 25, 1, 1);
  Triangles second = torusTriangles(4, 4);
  second.array() += 25;
  expect(joined(joined(torus, second), tetrahedron(41)), 45, 3, 2);
}

TEST(MeshTopology, DamagedSurfacesAreNoSpheres) {
  const auto of = [](const Triangles& triangles, std::size_t n) {
    const MeshTopology topology = checkTopology(triangles, n);
    EXPECT_FALSE(topology.isSphere());
    return topology;
  };
  EXPECT_FALSE(of(tetrahedron().leftCols(3), 4).closed);
  Triangles turned = tetrahedron();
  std::swap(turned(0, 1), turned(1, 1));
  EXPECT_FALSE(of(turned, 4).oriented);
  EXPECT_FALSE(of(joined(tetrahedron(), tetrahedron(3)), 7).vertex_manifold);
  EXPECT_FALSE(of(joined(tetrahedron(), trianglesOf({{0, 1, 4}})), 5).edge_manifold);
  EXPECT_FALSE(of(joined(tetrahedron(), trianglesOf({{0, 2, 1}})), 4).edge_manifold);
  EXPECT_FALSE(of(joined(tetrahedron(), trianglesOf({{0, 0, 1}})), 4).edge_manifold);
  EXPECT_EQ(of(tetrahedron(1), 6).unused_vertices, (std::vector<Index>{0, 5}));
  EXPECT_FALSE(of(Triangles(3, 0), 0).closed);
  EXPECT_FALSE(of(Triangles(3, 0), 3).closed);
}

void expectTopologyByDefinition(const Triangles& triangles, Index n) {
  const MeshTopology topology = checkTopology(triangles, static_cast<std::size_t>(n));
  const MeshTopology expected = reference::topologyOf(triangles, n);
  EXPECT_EQ(topology.vertices, expected.vertices);
  EXPECT_EQ(topology.edges, expected.edges);
  EXPECT_EQ(topology.triangles, expected.triangles);
  EXPECT_EQ(topology.components, expected.components);
  EXPECT_EQ(topology.euler_characteristic, expected.euler_characteristic);
  EXPECT_EQ(topology.closed, expected.closed);
  EXPECT_EQ(topology.edge_manifold, expected.edge_manifold);
  EXPECT_EQ(topology.oriented, expected.oriented);
  EXPECT_EQ(topology.nonmanifold_vertices, expected.nonmanifold_vertices);
  EXPECT_EQ(topology.unused_vertices, expected.unused_vertices);
}

TEST(MeshTopology, AgreesWithItsDefinitionOnRandomTriangles) {
  std::mt19937 random(5);
  for (int run = 0; run < 2000; ++run) {
    // From a few triangles apart to many more than fit around so few vertices.
    const Index n = 3 + static_cast<Index>(random() % 12);
    Triangles triangles(3, static_cast<Eigen::Index>(random() % 60));
    triangles =
        triangles.unaryExpr([&](Index) { return static_cast<Index>(random() % unsigned(n)); });
    SCOPED_TRACE(run);
    expectTopologyByDefinition(triangles, n);
  }
}

TEST(MeshTopology, AgreesWithItsDefinitionOnDamagedSurfaces) {
  std::mt19937 random(6);
  for (int run = 0; run < 300; ++run) {
    Triangles triangles = joined(torusTriangles(4, 4), joined(tetrahedron(16), tetrahedron(20)));
    for (int change = 0; change < run % 4; ++change)
      triangles.data()[random() % static_cast<unsigned>(triangles.size())] =
          static_cast<Index>(random() % 25);
    SCOPED_TRACE(run);
    expectTopologyByDefinition(triangles, 25);
  }
}

}  // namespace
}  // namespace spherical_param
