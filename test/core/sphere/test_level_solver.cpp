#include "level_solver.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(LevelSolver, SweepsLowerTheEnergyAndASolutionNeedsNoBarrier) {
  const Cloud cloud = dentedCloud(500);
  const GraphHierarchy none;
  const EmbeddingLevels levels(cloud.graph, none, 1);
  Positions u = projectFromCentroid(cloud.points);
  const double before = levels.energy(0, u);
  const double residual = meanTangentialLaplacian(cloud.graph, u, EdgeWeights::Adaptive);
  EXPECT_NEAR(levels.smooth(0, 1, {}, u), residual, 1e-14);
  EXPECT_LT(levels.energy(0, u), before);
  LevelReport report;
  EXPECT_LE(levels.solve(0, nullptr, {1e-9, 1e-10, {}}, u, report).back(), 1e-10);
  EXPECT_LT(levels.pull(0, u), 1e-8);
  EXPECT_GT(levels.pull(0, randomSphere(500, 1)), 0.1);
}

}  // namespace
}  // namespace spherical_param::test
