#include "unfolding.h"

#include "helpers.h"
#include "optimization_cases.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

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

}  // namespace
}  // namespace spherical_param::test
