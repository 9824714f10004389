// Which mesh a part gets, from the cloud on.

#include "attempts.h"

#include "core/reconstructions.h"
#include "handle_shapes.h"

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
  expectSoundWithHandles(surfaceOf(torusCloud(60, 24)), 1);
  expectSoundWithHandles(surfaceOf(doubleTorus(0.1)), 2);
  expectSoundWithHandles(surfaceOf(plateWithHoles(0.1)), 5);
  expectSoundWithHandles(surfaceOf(trefoil(0.2)), 1);
  expectSoundWithHandles(surfaceOf(latticeOfTubes(0.07)), 28);
}

TEST(Attempts, ThinTubesAndFatTori) {
  // Of 4 to 9 points around the tube, and of the least sizes.
  for (const int around : {4, 6, 9})
    EXPECT_EQ(surfaceOf(torusCloud(40, around, 1.0, 0.0225 * around)).topology.genus, 1) << around;
  for (const int rings : {24, 32})
    EXPECT_EQ(surfaceOf(torusCloud(rings, 12, 1.0, 0.5)).topology.genus, 1) << rings;
}

/// A random point of a torus of radius 1.
Eigen::Vector3d onTorus(std::mt19937_64& random, double tube) {
  std::uniform_real_distribution<double> turn(0.0, 2.0 * kPi);
  const double v = turn(random);
  return onCircle(turn(random), 1.0 + tube * std::cos(v), tube * std::sin(v));
}

TEST(Attempts, HandlesOfRandomSamplesAreKept) {
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
    EXPECT_EQ(result.genus() + result.diagnosis.cut_handles, 2U) << seed;
  }
}

TEST(Attempts, HandlesOfFewPointsAreKeptIfTheyPayAndSaidIfTheyCannot) {
  const auto torus_of = [](int n, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < n; ++i)
      points.push_back(onTorus(random, 0.35));
    return surfaceOf(positionsOf(points));
  };
  const Surface kept = torus_of(200, 3);
  EXPECT_EQ(kept.genus(), 1U);
  const Surface cut = torus_of(120, 3);
  EXPECT_EQ(cut.genus(), 0U);
  EXPECT_TRUE(isFound(cut, "handle"));
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

TEST(Attempts, LinkedRingsAreTwoParts) {
  const Positions ring = torusCloud(80, 20, 1.0, 0.25);
  Positions linked = ring;
  linked.row(1).swap(linked.row(2));
  linked.row(0).array() += 1.0;
  const Result result = reconstruct(horizontally(ring, linked), given("parts", "each"));
  ASSERT_EQ(result.surfaces.size(), 2U);
  for (const Surface& surface : result.surfaces)
    expectSoundWithHandles(surface, 1);
}

TEST(Attempts, ToriThatTouchAndOneSidedSurfacesAreSaidToBeUnsound) {
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

TEST(Attempts, WorksWithTheOtherOptions) {
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
