#include "relocation.h"

#include "helpers.h"
#include "optimization_cases.h"

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

TEST(Relocation, TakesOutAsManyVerticesAsThereAreAtMost) {
  const Case of = tangle(200);
  std::size_t rounds = 0;
  Execution execution;
  execution.progress = [&](const Progress&) { return ++rounds > 0; };
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, execution);
  for (const auto& [vertices, expected] : {std::pair(200, 1U), std::pair(50, 4U)}) {
    rounds = 0;
    internal::relocate(bench, range(0, vertices));
    EXPECT_LE(rounds, expected);
    EXPECT_GT(rounds, expected / 2);
  }
}

}  // namespace
}  // namespace spherical_param::test
