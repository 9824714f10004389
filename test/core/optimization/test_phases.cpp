#include "phases.h"

#include "helpers.h"
#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace spherical_param::test {
namespace {

TEST(Relocation, VerticesAtSharpEdgesOrFarFromTheirNeighboursAreRough) {
  EXPECT_TRUE(internal::roughVertices(meshOf(ellipsoid(500, 1.0, 1.0))).empty());
  // A cube's rims and corners alone: 8 + 12 * 4 of the points of a grid of 6.
  const Case cube = radialStart(cubeGrid(6));
  EXPECT_EQ(internal::roughVertices(meshOf(cube)).size(), 56U);
  // A vertex in the wrong place of a sphere is rough, whatever its angles.
  const Case sphere = ellipsoid(500, 1.0, 1.0);
  Case misplaced = sphere;
  for (Index& v : misplaced.triangles.reshaped())
    v = v == 100 ? 400 : v == 400 ? 100 : v;
  const std::vector<Index> rough = internal::roughVertices(meshOf(misplaced));
  for (const Index v : {100, 400})
    EXPECT_TRUE(std::binary_search(rough.begin(), rough.end(), v));
}

TEST(Relocation, PutsMisplacedVerticesBack) {
  Case of = ellipsoid(500, 1.0, 1.0);
  const double least = energyOf(of.points, of.triangles);
  for (Index& v : of.triangles.reshaped())
    v = v == 100 ? 400 : v == 400 ? 100 : v;
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  internal::relocate(bench, internal::roughVertices(bench.mesh));
  EXPECT_NEAR(energyOf(of.points, bench.mesh.mesh().triangles()), least, 1e-3 * least);
}

TEST(Untangling, TakesIntersectingTrianglesApart) {
  for (const int rounds_by_energy : {0, 2}) {
    const Case of = scrambledEllipsoid(300, 0.5, 600, 3);
    internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
    const auto pairs = internal::findIntersections(bench.mesh);
    EXPECT_GT(pairs.size(), 30U);
    EXPECT_TRUE(internal::untangle(bench, pairs, rounds_by_energy).empty());
    EXPECT_TRUE(findSelfIntersections(of.points, bench.mesh.mesh().triangles()).empty());
    EXPECT_TRUE(isSphereOverAll(bench.mesh.mesh().triangles(), 300));
  }
}

TEST(Untangling, ReportsWhatIsLeftOfATangle) {
  const Case of = tangle(100);
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  const auto left = internal::untangle(bench, internal::findIntersections(bench.mesh), 2);
  EXPECT_EQ(left, findSelfIntersections(of.points, bench.mesh.mesh().triangles()));
}

TEST(Unfolding, LeavesNoFoldedEdgeOfAScrambledMesh) {
  const Case of = scrambledEllipsoid(300, 0.5, 200, 3);
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  EXPECT_FALSE(internal::unfold(bench));
  EXPECT_LT(energyOf(of.points, bench.mesh.mesh().triangles()),
            0.8 * energyOf(of.points, of.triangles));
  // Nothing to do.
  const std::size_t recreated = bench.log.recreated;
  EXPECT_GT(recreated, 0U);
  EXPECT_FALSE(internal::unfold(bench));
  EXPECT_EQ(bench.log.recreated, recreated);
}

Triangles polished(const Case& of, double alignment, double unevenness) {
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  internal::polish(bench, {alignment, unevenness});
  return bench.mesh.mesh().triangles();
}

TEST(Polish, EndsWhenNoFlipGainsByTheEnergyOfTheSampling) {
  const Case of = noisySphere(300, 0.5, 2);
  const auto expect_least = [&](const Triangles& result, Bend bend, double mu) {
    EXPECT_TRUE(isSphereOverAll(result, 300));
    Case again = of;
    again.triangles = result;
    internal::EnergyMesh mesh = meshOf(again, bend, mu);
    EXPECT_EQ(internal::Flips(mesh).flipAll(), 0U);
  };
  expect_least(polished(of, 0.1, 0.1), Bend::Excess, 4.0);
  expect_least(polished(of, 0.4, 0.1), Bend::Power, 0.8);
  expect_least(polished(of, 0.1, 0.4), Bend::Power, 0.8);
}

}  // namespace
}  // namespace spherical_param::test
