// Surfaces with handles, from the cloud to the mesh.

#include "surface_topology.h"

#include "glued_spheres.h"
#include "graphs.h"
#include "handle_shapes.h"
#include "neighbor_search.h"
#include "reconstructions.h"
#include "rotation_system.h"

namespace spherical_param::test {
namespace {

TEST(SurfaceTopology, GluedMeshesHaveTheirLoopsAndAreNotCutByThem) {
  for (const Positions& points :
       {torusCloud(40, 16, 1.0, 0.4), doubleTorus(0.12), plateWithHoles(0.12)}) {
    const Graph graph =
        graphOf(points, findNearestNeighbors(points, 24), makeNeighborSearch(points)).graph;
    const Indexed<double> spacing = nodeSpacings(graph, 1);
    RotationSystem rotation(points, graph, spacing, 1);
    const Openings openings = findOpenings(points, graph, spacing, rotation);
    const std::vector<CutLoop> loops = findHandles(rotation, openings.openings).loops;
    const auto mesh =
        meshGluedSpheres(graph.size(), cutAlong(points, graph, rotation, loops), openings, {}, {});
    ASSERT_TRUE(mesh);
    // With a loop that divides it there were fewer handles than loops.
    EXPECT_TRUE(isSurfaceOverAll(mesh->triangles, static_cast<Index>(graph.size()),
                                 static_cast<Index>(loops.size())));
    const auto all = sidesOf(mesh->triangles);
    const std::set<std::pair<Index, Index>> sides(all.begin(), all.end());
    for (const CutLoop& loop : loops)
      for (std::size_t i = 0; i < loop.nodes.size(); ++i)
        EXPECT_EQ(sides.count({loop.nodes[i], loop.after(i)}), 1U);
  }
}

void expectSound(const Surface& result, Index genus) {
  test::expectSound(result, genus, 0);
  EXPECT_EQ(result.diagnosis.kind, SurfaceKind::Handles);
  EXPECT_TRUE(result.findings.empty());
  EXPECT_EQ(result.verdict,
            "A sound mesh with " + std::to_string(genus) + " handle" + (genus == 1 ? "." : "s."));
}

TEST(SurfaceTopology, HandlesAreMeshed) {
  expectSound(surfaceOf(torusCloud(60, 24)), 1);
  expectSound(surfaceOf(doubleTorus(0.1)), 2);
  expectSound(surfaceOf(plateWithHoles(0.1)), 5);
  expectSound(surfaceOf(trefoil(0.2)), 1);
  expectSound(surfaceOf(latticeOfTubes(0.07)), 28);
}

TEST(SurfaceTopology, ThinTubesAndFatTori) {
  // Of 4 to 9 points around the tube, and of the least sizes.
  for (const int around : {4, 6, 9})
    EXPECT_EQ(surfaceOf(torusCloud(40, around, 1.0, 0.0225 * around)).topology.genus, 1) << around;
  for (const int rings : {24, 32})
    EXPECT_EQ(surfaceOf(torusCloud(rings, 12, 1.0, 0.5)).topology.genus, 1) << rings;
}

TEST(SurfaceTopology, LoopsHaveTheirPlaceAndSize) {
  const Positions points = 10.0 * torusCloud(60, 24).array() + 3.0;
  const Surface result = surfaceOf(points);
  ASSERT_EQ(result.handles.size(), 1U);
  const HandleLoop& handle = result.handles.front();
  EXPECT_EQ(handle.loop.size(), 24U);
  EXPECT_NEAR(handle.length, 2.0 * kPi * 4.0, 0.3);
  EXPECT_NEAR((handle.center.array() - 3.0).matrix().norm(), 10.0, 0.1);
  EXPECT_EQ(handle.certainty, 1.0);
  EXPECT_FALSE(handle.is_cut);
  EXPECT_EQ(*std::min_element(handle.loop.begin(), handle.loop.end()), handle.loop.front());
}

/// A random point of a torus of radius 1.
Eigen::Vector3d onTorus(std::mt19937_64& random, double tube) {
  std::uniform_real_distribution<double> turn(0.0, 2.0 * kPi);
  const double v = turn(random);
  return onCircle(turn(random), 1.0 + tube * std::cos(v), tube * std::sin(v));
}

TEST(SurfaceTopology, LoopsAreShortHoweverRoughTheirSurface) {
  // Two tori that share a part.
  constexpr double tube = 0.35;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<Eigen::Vector3d> points;
    while (points.size() < 700) {
      const Eigen::Vector3d p = onTorus(random, tube);
      if (p.x() < 0.95)
        points.push_back(points.size() % 2 == 0 ? p : Eigen::Vector3d(1.9 - p.x(), p.y(), p.z()));
    }
    const Surface result = surfaceOf(positionsOf(points));
    EXPECT_EQ(result.handles.size(), 2U);
    for (const HandleLoop& handle : result.handles)
      EXPECT_LT(handle.length, 1.2 * 2.0 * kPi * tube);
  }
}

TEST(SurfaceTopology, HandlesOfFewPointsAreKeptIfTheyPayAndSaidIfTheyCannot) {
  const auto torus_of = [](int n, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < n; ++i)
      points.push_back(onTorus(random, 0.35));
    return surfaceOf(positionsOf(points));
  };
  const Surface kept = torus_of(200, 3);
  EXPECT_EQ(kept.genus(), 1U);
  ASSERT_EQ(kept.handles.size(), 1U);
  EXPECT_LT(kept.handles[0].certainty, 1.0);
  EXPECT_FALSE(kept.handles[0].is_cut);
  // No mesh along this loop can be glued.
  const Surface cut = torus_of(120, 3);
  EXPECT_EQ(cut.genus(), 0U);
  ASSERT_EQ(cut.handles.size(), 1U);
  EXPECT_TRUE(cut.handles[0].is_cut);
  EXPECT_TRUE(isFound(cut, "handle"));
}

TEST(SurfaceTopology, HandlesBesideOpenings) {
  const Positions torus = torusCloud(80, 30, 2.5, 1.0);
  for (const double beside : {3.5, 1.5}) {  // outside, and in the hole of the torus
    const Positions holed = pointsWhere(
        torus, [&](const auto& p) { return (p - Eigen::Vector3d(beside, 0.0, 0.0)).norm() > 0.7; });
    const Surface result = surfaceOf(holed, given("surface", "open"));
    test::expectSound(result, 1, 1);
    EXPECT_EQ(result.verdict, "A sound mesh with 1 handle and 1 opening.");
  }
}

TEST(SurfaceTopology, LinkedRingsAreTwoParts) {
  const Positions ring = torusCloud(80, 20, 1.0, 0.25);
  Positions linked = ring;
  linked.row(1).swap(linked.row(2));
  linked.row(0).array() += 1.0;
  const Result result = reconstruct(horizontally(ring, linked), given("parts", "each"));
  ASSERT_EQ(result.surfaces.size(), 2U);
  for (const Surface& surface : result.surfaces)
    expectSound(surface, 1);
}

TEST(SurfaceTopology, ToriThatTouchAndOneSidedSurfacesAreSaidToBeUnsound) {
  Positions tori = horizontally(torusCloud(60, 24), torusCloud(60, 24));
  tori.row(0).tail(60 * 24).array() += 2.82;
  for (const Positions& points : {tori, kleinBottle(60, 30), moebiusBand(160, 12)}) {
    const Surface result = surfaceOf(points, given(quick(sphere()), "handles", "auto"));
    EXPECT_TRUE(isSurfaceOverAll(result.triangles, static_cast<Index>(points.cols()),
                                 static_cast<Index>(result.genus())));
    EXPECT_FALSE(result.findings.empty());
  }
  EXPECT_TRUE(surfaceOf(kleinBottle(60, 30), quick()).diagnosis.is_one_sided);
}

TEST(SurfaceTopology, WorksWithTheOtherOptions) {
  const Positions torus = torusCloud(60, 24);
  const Surface smooth = surfaceOf(torus, watched(given("smoothing", 3)));
  EXPECT_EQ(smooth.topology.genus, 1);
  EXPECT_NE(smooth.points, torus);
  EXPECT_TRUE(smooth.vertex_residuals.empty());
  EXPECT_TRUE(smooth.history.frames.empty());
  const Options consolidated = given("consolidation", "auto", "outliers", "auto");
  const Positions scattered =
      horizontally(withNoise(torus, 0.01, 2), Eigen::Vector3d(0.0, 0.0, 3.0));
  EXPECT_EQ(surfaceOf(scattered, consolidated).topology.genus, 1);
  EXPECT_EQ(surfaceOf(torus, quick()).topology.genus, 1);
  // The published method is a sphere.
  EXPECT_EQ(surfaceOf(torus, quick(paper())).topology.genus, 0);
}

TEST(SurfaceTopology, WithinATimeLimitThereIsASurface) {
  const Positions torus = torusCloud(30, 12);
  for (const double seconds : {0.0, 1e-3, 3e-3, 1e-2}) {
    const Surface hasty = surfaceOf(torus, given("time_limit", seconds));
    EXPECT_TRUE(hasty.topology.isSurface() && hasty.topology.closed);
    EXPECT_EQ(hasty.topology.vertices, static_cast<std::size_t>(torus.cols()));
    EXPECT_EQ(hasty.genus(), static_cast<std::size_t>(*hasty.topology.genus));
  }
}

}  // namespace
}  // namespace spherical_param::test
