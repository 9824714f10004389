#include "intersection_removal.h"

#include "core/optimization/optimization_cases.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

TEST(IntersectionRemoval, OtherPlacesInTheMeshKeepEveryVertex) {
  const auto expect_clear = [](const Positions& points, SphereMesh mesh) {
    const auto n = static_cast<Index>(points.cols());
    const auto pairs = findSelfIntersections(points, mesh.triangles());
    ASSERT_FALSE(pairs.empty());
    const Removal removal = clearIntersections(points, pairs, {20, 20}, mesh);
    EXPECT_EQ(removal.vertices + removal.triangles, 0U);
    EXPECT_TRUE(isSphereOverAll(mesh.triangles(), n));
    EXPECT_TRUE(findSelfIntersections(points, mesh.triangles()).empty());
  };
  const Case scrambled = scrambledEllipsoid(300, 0.3, 100, 2);
  expect_clear(scrambled.points, SphereMesh(scrambled.triangles, 300));
  // Noise of a spacing: hundreds of intersections.
  const Positions noisy = withNoise(spiralSphere(600), sphereSpacing(600), 1);
  expect_clear(noisy, SphereMesh(triangulateSphere(spiralSphere(600)), 600));
}

TEST(IntersectionRemoval, WhereNoPlaceHelpsAVertexOrTrianglesAreLeftOutWithinLimits) {
  for (const Removal& most : {Removal{1, 0}, Removal{0, 20}, Removal{0, 0}}) {
    // A flat disc, one of whose inner vertices is outside of it, in its plane.
    Positions points = spiralSphere(400);
    SphereMesh mesh(triangulateSphere(points), 400);
    Index top = 0;
    points.row(2).maxCoeff(&top);
    for (Index t = 0; t < mesh.size(); ++t)
      mesh.setOpen(t, points(2, mesh.triangles().col(t)).minCoeff() < 0.0);
    points.row(2).setZero();
    points.col(top) << 5.0, 0.0, 0.0;
    const std::vector<Index> surface = mesh.surface();
    auto pairs = findSelfIntersections(points, mesh.surfaceTriangles());
    ASSERT_FALSE(pairs.empty());
    for (auto& pair : pairs)
      for (Index& t : pair)
        t = surface[static_cast<std::size_t>(t)];
    const std::size_t vertices = mesh.surfaceVertexCount();
    const Removal removal = clearIntersections(points, pairs, most, mesh);
    EXPECT_EQ(removal.vertices, most.vertices);
    EXPECT_EQ(removal.triangles > 0U, most.triangles > 0U);
    EXPECT_EQ(findSelfIntersections(points, mesh.surfaceTriangles()).empty(),
              most.vertices + most.triangles > 0);
    const MeshTopology topology = checkTopology(mesh.surfaceTriangles(), 400);
    EXPECT_TRUE(topology.manifold() && topology.oriented);
    EXPECT_EQ(topology.components, 1U);
    EXPECT_LE(mesh.surfaceVertexCount(), vertices - most.vertices);
    EXPECT_EQ(topology.triangles + removal.triangles + 2 * removal.vertices, surface.size());
  }
}

TEST(IntersectionRemoval, ATangleIsLeftOutAsAWhole) {
  // A third of the vertices are anywhere.
  Positions points = spiralSphere(600);
  points.rightCols(200) = randomCube(200, 1) * 0.2;
  SphereMesh mesh(triangulateSphere(spiralSphere(600)), 600);
  const std::size_t left_out =
      leaveOutTangles(600, findSelfIntersections(points, mesh.triangles()), mesh);
  const Triangles surface = mesh.surfaceTriangles();
  EXPECT_GT(left_out, 200U);
  EXPECT_LE(left_out + columnCount(surface), 1196U);
  EXPECT_TRUE(findSelfIntersections(points, surface).empty());
  const MeshTopology topology = checkTopology(surface, 600);
  EXPECT_TRUE(topology.manifold() && topology.oriented);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_GT(surface.cols(), 700);
}

TEST(IntersectionRemoval, SmallPiecesAreLeftOutButTheLargest) {
  const Positions points = spiralSphere(600);
  const Triangles triangles = triangulateSphere(points);
  // The number of triangles within a height of the pole, and of those that stay if they are a piece
  // of their own beside the rest of the sphere, or alone.
  const auto kept_of = [&](double height, bool is_alone) {
    SphereMesh mesh(triangles, 600);
    Index cap = 0;
    for (Index t = 0; t < mesh.size(); ++t) {
      const double lowest = points(2, triangles.col(t)).minCoeff();
      cap += lowest > height ? 1 : 0;
      mesh.setOpen(t, lowest <= height && (is_alone || lowest > height - 0.2));
    }
    const auto before = static_cast<Eigen::Index>(mesh.surfaceCount());
    EXPECT_EQ(leaveOutTangles(600, {}, mesh), 0U);
    return std::pair(cap, cap - (before - static_cast<Eigen::Index>(mesh.surfaceCount())));
  };
  const auto [small, kept_of_small] = kept_of(0.93, false);
  ASSERT_TRUE(small > 20 && small < 50) << small;
  EXPECT_EQ(kept_of_small, 0);
  EXPECT_EQ(kept_of(0.93, true), std::pair(small, Eigen::Index{small}));
  const auto [large, kept_of_large] = kept_of(0.86, false);
  ASSERT_TRUE(large >= 50 && large < 100) << large;
  EXPECT_EQ(kept_of_large, large);
}

}  // namespace
}  // namespace spherical_param::test
