#include "mesh_cleaning.h"

#include "core/reconstructions.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

PartMesh cleaned(const Positions& points, PartMesh mesh, const Options& options) {
  cleanMesh(points, withTopology(options), {}, mesh);
  EXPECT_EQ(findSelfIntersections(points, mesh.mesh.surfaceTriangles()), mesh.intersecting.pairs);
  return mesh;
}

TEST(MeshCleaning, TakesASpotApartUnlessTheOptionsForbidIt) {
  Positions points = spiralSphere(600);
  points.col(200) *= -1.5;
  PartMesh mesh;
  mesh.mesh = SphereMesh(triangulateSphere(spiralSphere(600)), 600);
  mesh.intersecting.pairs = findSelfIntersections(points, mesh.mesh.triangles());
  ASSERT_FALSE(mesh.intersecting.pairs.empty());
  const auto is_cleaned = [&](const Options& options) {
    const PartMesh result = cleaned(points, mesh, options);
    EXPECT_TRUE(isSphereOverAll(result.mesh.surfaceTriangles(), 600));
    EXPECT_EQ(result.left_out_triangles, 0U);
    return result.intersecting.pairs.empty();
  };
  EXPECT_TRUE(is_cleaned({}));
  EXPECT_TRUE(is_cleaned(given("surface", "closed")));
  EXPECT_TRUE(is_cleaned(given("intersections", "keep")));
  EXPECT_TRUE(is_cleaned(sphere()));
  EXPECT_FALSE(is_cleaned(given(paper(), "intersections", "remove")));
  mesh.optimization.is_out_of_time = true;
  EXPECT_FALSE(is_cleaned({}));
  // What was counted before the points were smoothed is not what intersects now.
  mesh.optimization.is_out_of_time = false;
  mesh.smoothed = points;
  mesh.intersecting = {};
  EXPECT_TRUE(is_cleaned({}));
}

/// A thin body with noise of 0.3 distances of its points.
Positions noisyLens(Index n, double thickness, std::uint64_t seed) {
  return withNoise(Eigen::Vector3d(1.0, 1.0, thickness).asDiagonal() * spiralSphere(n),
                   0.3 * sphereSpacing(n), seed);
}

TEST(MeshCleaning, AClosedMeshStaysClosedWithAllPoints) {
  for (const Positions& points : {noisyLens(400, 0.2, 9), noisyLens(600, 0.16, 1)}) {
    const Result result = reconstruct(points);
    expectSound(result.surface(), 0, 0);
    EXPECT_TRUE(result.left_out.text().empty());
  }
}

TEST(MeshCleaning, WhatCannotBeTakenApartIsAHoleOnRequestAlone) {
  const Positions points = noisyLens(1500, 0.1, 8);
  const Surface kept = surfaceOf(points, given("consolidation", "none"));
  EXPECT_TRUE(isSphereOverAll(kept.triangles, 1500));
  EXPECT_TRUE(kept.isUsable());
  EXPECT_EQ(kept.left_out_triangles, 0U);
  const Surface removed =
      surfaceOf(points, given("intersections", "remove", "consolidation", "none"));
  EXPECT_EQ(removed.intersecting_triangles, 0U);
  EXPECT_EQ(removed.isClosed(), kept.intersecting_triangles == 0);
}

/// Random points of a plate whose two sides, which false edges join, are nearer to each other than
/// their points.
Positions thinPlate(std::uint64_t seed) {
  return Eigen::Vector3d(1.0, 1.0, 0.1).asDiagonal() * randomSphere(300, seed);
}

TEST(MeshCleaning, AScanHasNoIntersectionsAndASphereEveryPoint) {
  const Positions points = thinPlate(9);  // the sphere is a tangle
  const Result scan = reconstruct(points);
  const Surface& surface = scan.surface();
  EXPECT_EQ(surface.intersecting_triangles, 0U);
  EXPECT_TRUE(surface.topology.manifold() && surface.topology.oriented);
  const std::vector<Index>& unmeshed = scan.left_out.unmeshed;
  EXPECT_TRUE(std::is_sorted(unmeshed.begin(), unmeshed.end()));
  EXPECT_EQ(surface.inputs.size() + unmeshed.size() + scan.left_out.outliers.size(), 300U);
  for (const Index i : unmeshed)
    EXPECT_EQ(surface.vertexOf(i), -1);
  const Surface sphere = surfaceOf(points, test::sphere());
  EXPECT_TRUE(isSphereOverAll(sphere.triangles, 300));
  EXPECT_GT(sphere.intersecting_triangles, 0U);
}

TEST(MeshCleaning, RandomPointsOfThinPlatesAreAllMeshed) {
  for (std::uint64_t seed = 11; seed < 18; ++seed)
    EXPECT_TRUE(reconstruct(thinPlate(seed)).left_out.unmeshed.empty()) << seed;
}

TEST(MeshCleaning, OfATangleTheTrianglesThatAreCertainStay) {
  const Positions points = terraces();
  const Result scan = reconstruct(points);
  const Surface& surface = scan.surface();
  EXPECT_TRUE(surface.has_certain_triangles_only);
  EXPECT_TRUE(findSelfIntersections(points(Eigen::all, surface.input_of_vertex), surface.triangles)
                  .empty());
  EXPECT_TRUE(surface.topology.manifold() && surface.topology.oriented);
  EXPECT_EQ(surface.topology.boundary_loops, surface.boundary.size());
  EXPECT_GT(surface.triangles.cols(), 150);
  EXPECT_GT(scan.left_out.unmeshed.size(), 50U);
  EXPECT_EQ(surface.sphere.cols(), 0);
  for (const Opening& opening : surface.openings)
    EXPECT_EQ(opening.is_filled, !opening.triangles.empty());
  EXPECT_NE(scan.verdict.find("has only the triangles that are certain"), std::string::npos);
  EXPECT_FALSE(surfaceOf(points, sphere()).has_certain_triangles_only);
}

TEST(MeshCleaning, ATangleAmongOtherPartsIsLeftOut) {
  // A line with three bends, in one plane.
  const Positions bent = pointsAt(200, [](Index i) {
    const double angle = 2.0 * kPi * i / 200;
    return onCircle(angle, 0.32 + 0.048 * std::cos(3.0 * angle));
  });
  const Result scan = reconstruct(horizontally(0.3 * spiralSphere(600), movedTo(2.0, bent)));
  EXPECT_EQ(scan.surfaces.size(), 1U);
  EXPECT_EQ(scan.left_out.other_parts.size(), 200U);
  ASSERT_EQ(scan.failures.size(), 1U);
  EXPECT_EQ(scan.failures[0],
            "1 part (200 points) cannot be meshed: more than 1 % of the triangles intersect");
  // Alone it stays.
  EXPECT_FALSE(reconstruct(bent).isUsable());
}

}  // namespace
}  // namespace spherical_param::test
