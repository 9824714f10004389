#include "attempts.h"

#include "core/reconstructions.h"
#include "graphs.h"
#include "handle_shapes.h"
#include "neighbor_search.h"

namespace spherical_param::test {
namespace {

void expectSoundWithHandles(const Surface& result, Index genus) {
  expectSound(result, genus, 0);
  EXPECT_EQ(result.diagnosis.cut_handles, 0U);
  EXPECT_TRUE(result.findings.empty());
  EXPECT_EQ(result.verdict,
            "A sound mesh with " + std::to_string(genus) + " handle" + (genus == 1 ? "." : "s."));
}

TEST(Attempts, HandlesAreMeshed) {
  expectSoundWithHandles(surfaceOf(doubleTorus(0.1)), 2);
  expectSoundWithHandles(surfaceOf(plateWithHoles(0.1)), 5);
  expectSoundWithHandles(surfaceOf(latticeOfTubes(0.07)), 28);
  expectSoundWithHandles(surfaceOf(gear(0.07)), 1);
  const Positions lattice = latticeOfTubes(0.05);
  std::vector<Index> some = shuffledRange(lattice.cols(), 1);
  some.resize(some.size() / 4);  // at random
  expectSoundWithHandles(surfaceOf(lattice(Eigen::all, some)), 28);
}

bool hasEmbedding(const Result& result) {
  return std::any_of(result.stages.begin(), result.stages.end(),
                     [](const StageTime& stage) { return stage.name == "embedding"; });
}

TEST(Attempts, ThinTubesAndFatTori) {
  // Of 4 to 9 points around the tube, and of the least sizes.
  for (const int around : {4, 9})
    EXPECT_EQ(surfaceOf(torusCloud(40, around, 1.0, 0.0225 * around)).topology.genus, 1) << around;
  EXPECT_EQ(surfaceOf(torusCloud(24, 12, 1.0, 0.5)).topology.genus, 1);
}

/// A random point of a torus of radius 1.
Eigen::Vector3d onTorus(std::mt19937_64& random, double tube) {
  std::uniform_real_distribution<double> turn(0.0, 2.0 * kPi);
  const double v = turn(random);
  return onCircle(turn(random), 1.0 + tube * std::cos(v), tube * std::sin(v));
}

/// Random points of two tori that share a part.
Positions randomDoubleTorus(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Eigen::Vector3d> points;
  while (points.size() < 700) {
    const Eigen::Vector3d p = onTorus(random, 0.35);
    if (p.x() < 0.95)
      points.push_back(points.size() % 2 == 0 ? p : Eigen::Vector3d(1.9 - p.x(), p.y(), p.z()));
  }
  return positionsOf(points);
}

TEST(Attempts, HandlesOfRandomSamplesAreMeshedOrReported) {
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    expectSound(surfaceOf(randomDoubleTorus(seed)), 2, 0);
  const auto torus_of = [](Index n) {
    std::mt19937_64 random(3);
    return surfaceOf(pointsAt(n, [&](Index) { return onTorus(random, 0.35); }));
  };
  expectSound(torus_of(200), 1, 0);
  EXPECT_EQ(torus_of(120).genus(), 0U);
  EXPECT_TRUE(hasFault(torus_of(120).findings));
}

TEST(Attempts, HandlesThatAreNotWantedAreCutAndCounted) {
  const Options none = given("handles", "none");
  for (const auto& [points, options, genus] : {std::tuple(torusCloud(60, 24), none, 1U),
                                               {torusCloud(60, 24), sphere(), 1U},
                                               {doubleTorus(0.15), none, 2U},
                                               {gear(0.1), none, 1U}}) {
    const Surface result = surfaceOf(points, options);
    EXPECT_EQ(result.genus(), 0U);
    EXPECT_EQ(result.diagnosis.cut_handles, genus);
    EXPECT_TRUE(hasFault(result.findings));
  }
  // A mesh of the certain faces alone.
  EXPECT_EQ(surfaceOf(latticeOfTubes(0.07), none).genus(), 0U);
}

TEST(Attempts, WhereTheFacesCloseUpThereIsASphereOnRequestAlone) {
  for (const Positions& points : {ellipsoid(800), sphereWithHoles(1500, 2, 0.4)}) {
    const Result plain = reconstruct(points);
    EXPECT_FALSE(hasEmbedding(plain));
    EXPECT_EQ(plain.surface().sphere.cols(), 0);
    Options details;
    details.details = true;
    for (const Options& options : {details, given("tolerance", 1e-6)}) {
      const Surface seen = surfaceOf(points, options);
      ASSERT_EQ(seen.sphere.cols(), points.cols());
      EXPECT_GT(volumeOf(seen.sphere, seen.triangles), 0.0);
      EXPECT_EQ(seen.triangles, plain.surface().triangles);
    }
    EXPECT_EQ(surfaceOf(points, sphere()).sphere.cols(), points.cols());
  }
  const Result torus = reconstruct(torusCloud(60, 24), withDetails());
  expectSoundWithHandles(torus.surface(), 1);
  EXPECT_FALSE(hasEmbedding(torus));
  EXPECT_EQ(torus.surface().sphere.cols(), 0);
}

TEST(Attempts, AFalseHandleOfNoiseIsNotTakenWhereASphereIsSound) {
  const Positions points = noisySphere(1500, 0.6);
  const Graph graph =
      graphOf(points, findNearestNeighbors(points, 24), makeNeighborSearch(points)).graph;
  const auto faces =
      meshFaces(points, graph, RotationSystem(points, graph, nodeSpacings(graph, 1), 1));
  ASSERT_TRUE(faces);
  ASSERT_EQ(faces->genus(), 1U);
  const Result result = reconstruct(points, given("consolidation", "none"));
  EXPECT_TRUE(hasEmbedding(result));
  expectSound(result.surface(), 0, 0);
  EXPECT_EQ(result.surface().diagnosis.cut_handles, 0U);
}

TEST(Attempts, TheFacesOfTheGraphTakeThePlaceOfATangle) {
  // The embedding of spheres side by side is folded.
  const Positions points = inARow(4, 2.6, spiralSphere(150));
  for (const Options& options : {sphere(), given("parts", "all")}) {
    const Surface result = surfaceOf(points, options);
    expectSound(result, 0, 0);
    EXPECT_EQ(result.vertexCount(), 600U);
  }
}

TEST(Attempts, HandlesBesideOpenings) {
  const Positions torus = torusCloud(80, 30, 2.5, 1.0);
  for (const double beside : {3.5, 1.5}) {  // outside, and in the hole of the torus
    const Positions holed = pointsWhere(
        torus, [&](const auto& p) { return (p - Eigen::Vector3d(beside, 0.0, 0.0)).norm() > 0.7; });
    const Surface result = surfaceOf(holed, given("surface", "open"));
    expectSound(result, 1, 1);
    EXPECT_EQ(result.verdict, "A sound mesh with 1 handle and 1 opening.");
  }
}

TEST(Attempts, ToriThatTouchAndOneSidedSurfacesHaveFindings) {
  Positions tori = horizontally(torusCloud(60, 24), torusCloud(60, 24));
  tori.row(0).tail(60 * 24).array() += 2.82;
  for (const Positions& points : {tori, kleinBottle(60, 30), moebiusBand(160, 12)}) {
    const Surface result = surfaceOf(points, given(quick(sphere()), "handles", "auto"));
    EXPECT_TRUE(isSurfaceOverAll(result.triangles, static_cast<Index>(points.cols()),
                                 static_cast<Index>(result.genus())));
    EXPECT_FALSE(result.findings.empty());
  }
  for (const Options& options : {Options(), quick()}) {
    const Surface result = surfaceOf(kleinBottle(60, 30), options);
    EXPECT_TRUE(result.diagnosis.is_one_sided);
    EXPECT_TRUE(hasFault(result.findings));
  }
}

TEST(Attempts, WorksWithTheOtherOptions) {
  const Positions torus = torusCloud(60, 24);
  const Surface smooth = surfaceOf(torus, withDetails(given("smoothing", 3)));
  EXPECT_EQ(smooth.topology.genus, 1);
  EXPECT_NE(smooth.points, torus);
  EXPECT_TRUE(smooth.vertex_residuals.empty());
  const Options consolidated = given("consolidation", "auto", "outliers", "auto");
  const Positions scattered =
      horizontally(withNoise(torus, 0.01, 2), Eigen::Vector3d(0.0, 0.0, 3.0));
  EXPECT_EQ(surfaceOf(scattered, consolidated).topology.genus, 1);
}

TEST(Attempts, WithinATimeLimitThereIsASurface) {
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
