#include "spherical_param/mesh_topology.h"

#include "helpers.h"
#include "reference/mesh_topology.h"
#include "spherical_param/errors.h"
#include "triangle_lists.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <random>
#include <vector>

namespace spherical_param {
namespace {

using test::tetrahedron;
using test::trianglesOf;

Triangles joined(const Triangles& a, const Triangles& b) {
  Triangles result(3, a.cols() + b.cols());
  result << a, b;
  return result;
}

/// An m x m grid of quads, closed to a torus.
Triangles torus(Index m) {
  Triangles triangles(3, 2 * m * m);
  Eigen::Index t = 0;
  const auto at = [m](Index i, Index j) { return (i % m) * m + j % m; };
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) {
      triangles.col(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      triangles.col(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  return triangles;
}

TEST(MeshTopology, TetrahedronIsASphere) {
  const MeshTopology topology = checkTopology(tetrahedron(), 4);
  EXPECT_TRUE(topology.isSphere());
  EXPECT_EQ(topology.vertices, 4U);
  EXPECT_EQ(topology.edges, 6U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_EQ(topology.genus, 0);
}

TEST(MeshTopology, TorusHasGenusOne) {
  const MeshTopology topology = checkTopology(torus(5), 25);
  EXPECT_TRUE(topology.closed && topology.manifold() && topology.oriented);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 0);
  EXPECT_EQ(topology.genus, 1);
  EXPECT_FALSE(topology.isSphere());
}

TEST(MeshTopology, GenusAddsUpOverComponents) {
  Triangles second = torus(4);
  second.array() += 25;
  const MeshTopology topology =
      checkTopology(joined(joined(torus(5), second), tetrahedron(41)), 45);
  EXPECT_EQ(topology.components, 3U);
  EXPECT_EQ(topology.genus, 2);
  EXPECT_FALSE(topology.isSphere());
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
}

TEST(MeshTopology, EmptyMeshIsNotClosed) {
  EXPECT_FALSE(checkTopology(Triangles(3, 0), 0).closed);
  EXPECT_FALSE(checkTopology(Triangles(3, 0), 3).isSphere());
}

TEST(MeshTopology, BadInputIsInvalidInput) {
  EXPECT_THROW(checkTopology(tetrahedron(), 3), InvalidInput);
  EXPECT_THROW(checkTopology(trianglesOf({{0, 1, -1}}), 3), InvalidInput);
  for (const int threads : {-1, 1025})
    EXPECT_THROW(checkTopology(tetrahedron(), 4, threads), InvalidInput);
}

void expectSameTopology(const MeshTopology& topology, const MeshTopology& expected) {
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
    expectSameTopology(checkTopology(triangles, static_cast<std::size_t>(n)),
                       reference::topologyOf(triangles, n));
  }
}

TEST(MeshTopology, AgreesWithItsDefinitionOnDamagedSurfaces) {
  std::mt19937 random(6);
  for (int run = 0; run < 300; ++run) {
    Triangles triangles = joined(torus(4), joined(tetrahedron(16), tetrahedron(20)));
    for (int change = 0; change < run % 4; ++change)
      triangles.data()[random() % static_cast<unsigned>(triangles.size())] =
          static_cast<Index>(random() % 25);
    SCOPED_TRACE(run);
    expectSameTopology(checkTopology(triangles, 25), reference::topologyOf(triangles, 25));
  }
}

TEST(MeshTopology, VolumeAndAreaOfATetrahedron) {
  Positions points(3, 4);
  points << 0, 1, 0, 0,  //
      0, 0, 1, 0,        //
      0, 0, 0, 1;
  // Exact values of the corner of the unit cube.
  EXPECT_DOUBLE_EQ(signedVolume(points, tetrahedron()), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(surfaceArea(points, tetrahedron()), 1.5 + std::sqrt(3.0) / 2.0);
  Triangles turned = tetrahedron();
  flipOrientation(turned);
  EXPECT_DOUBLE_EQ(signedVolume(points, turned), -1.0 / 6.0);
  // A far origin costs digits only in the coordinates themselves.
  points.array() += 1e6;
  EXPECT_NEAR(signedVolume(points, tetrahedron()), 1.0 / 6.0, 1e-9);
}

}  // namespace
}  // namespace spherical_param
