#include "energy_mesh.h"

#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Flips, merges and splits at random.
void moveAtRandom(EnergyMesh& mesh, std::mt19937_64& random) {
  for (int i = 0; i < 200; ++i) {
    const auto t = static_cast<Index>(random() % static_cast<std::uint64_t>(mesh.mesh().size()));
    const auto k = static_cast<int>(random() % 3);
    mesh.flip(t, k, mesh.flipGain(t, k, -kInfinity));
    const Index v = mesh.mesh().vertex(t, k);
    const Index w = mesh.mesh().vertex(t, (k + 1) % 3);
    if (!mesh.merge(v))
      continue;
    const Index at = mesh.mesh().triangleAt(w);
    mesh.split(at, v, mesh.splitCost(at, v, kInfinity));
  }
}

TEST(EnergyMesh, TheChangeIsThatOfTheEnergyByItsDefinition) {
  for (const Case& of : roughCases())
    for (const Bend bend : {Bend::Angle, Bend::Power, Bend::Excess}) {
      SCOPED_TRACE(static_cast<int>(bend));
      EnergyMesh mesh = meshOf(of, bend, 0.8);
      std::mt19937_64 random(5);
      for (int round = 0; round < 3; ++round) {
        const double before = energyOf(of.points, mesh.mesh().triangles(), bend, 0.8);
        EXPECT_NEAR(mesh.energy() * mesh.unit(), before, 1e-7 * before);
        mesh.begin();
        moveAtRandom(mesh, random);
        const double change = mesh.change() * mesh.unit();
        mesh.commit();
        const Triangles triangles = mesh.mesh().triangles();
        const double after = energyOf(of.points, triangles, bend, 0.8);
        // acos near folds and flat edges loses half of the digits against atan2.
        EXPECT_NEAR(change, after - before, 1e-7 * (before + after));
        EXPECT_NE(change, 0.0);
        EXPECT_TRUE(isSphereOverAll(triangles, static_cast<Index>(of.points.cols())));
      }
    }
}

TEST(EnergyMesh, RollingBackRestoresEveryBit) {
  const Case of = roughCases().front();
  EnergyMesh mesh = meshOf(of);
  const auto gains = [&] {
    std::vector<double> all;
    for (Index t = 0; t < mesh.mesh().size(); ++t)
      for (int k = 0; k < 3; ++k)
        all.push_back(mesh.flipGain(t, k, -kInfinity));
    return all;
  };
  std::mt19937_64 random(6);
  const Triangles triangles = mesh.mesh().triangles();
  const std::vector<double> before = gains();
  mesh.begin();
  moveAtRandom(mesh, random);
  const Triangles moved = mesh.mesh().triangles();
  const std::vector<double> between = gains();
  const double change = mesh.change();
  EXPECT_FALSE(mesh.changed().empty());
  mesh.begin();
  moveAtRandom(mesh, random);
  EXPECT_NE(mesh.mesh().triangles(), moved);
  mesh.rollBack();
  EXPECT_EQ(mesh.mesh().triangles(), moved);
  EXPECT_EQ(gains(), between);
  EXPECT_EQ(mesh.change(), change);
  mesh.rollBack();
  EXPECT_EQ(mesh.mesh().triangles(), triangles);
  EXPECT_EQ(gains(), before);
}

TEST(EnergyMesh, IntersectionsAreThoseOfItsTrianglesAlsoAfterChanges) {
  for (const Case& of : roughCases()) {
    EnergyMesh mesh = meshOf(of);
    const auto expected = [&](const Positions& points) {
      return findSelfIntersections(points, mesh.mesh().triangles());
    };
    IntersectingPairs found = findIntersections(mesh, 10000, {});
    EXPECT_EQ(found.pairs, expected(of.points));
    EXPECT_TRUE(found.pairs.empty() || findIntersections(mesh, 1, {}).is_sample);
    EXPECT_EQ(mesh.takeTouched().size(), columnCount(of.triangles));
    EXPECT_TRUE(mesh.takeTouched().empty());
    std::mt19937_64 random(7);
    for (const bool is_kept : {true, false, true}) {
      mesh.begin();
      moveAtRandom(mesh, random);
      if (is_kept)
        mesh.commit();
      else
        mesh.rollBack();
      updateIntersections(mesh, mesh.takeTouched(), found);
      EXPECT_EQ(found.pairs, expected(of.points));
    }
    // Other positions of the same points.
    const Positions moved = withNoise(of.points, 0.05, 8);
    mesh.setPoints(moved);
    EXPECT_EQ(findIntersections(mesh, 10000, {}).pairs, expected(moved));
  }
}

TEST(EnergyMesh, GainsAndCostsBeyondTheirBoundsAreExact) {
  for (const Case& of : roughCases()) {
    EnergyMesh mesh = meshOf(of);
    for (Index t = 0; t < mesh.mesh().size(); ++t) {
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.flipGain(t, k, 0.0), std::max(mesh.flipGain(t, k, -kInfinity), 0.0));
      EXPECT_EQ(mesh.splitCost(t, 7, 0.1), std::min(mesh.splitCost(t, 7, kInfinity), 0.1));
    }
  }
}

}  // namespace
}  // namespace spherical_param::test
