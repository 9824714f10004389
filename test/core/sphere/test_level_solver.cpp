#include "level_solver.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(LevelSolver, TheCentroidIsThatOfTheSurfaceOnEachLevel) {
  const Cloud cloud = dentedCloud(2000);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 100);
  const EmbeddingLevels levels(cloud.graph, hierarchy, 1);
  ASSERT_GE(levels.coarsest(), 2U);
  const Eigen::Vector3d place = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  EXPECT_LT((levels.centroid(0, place.replicate(1, 2000)) - place).norm(), 1e-12);
  for (std::size_t l = 1; l <= levels.coarsest(); ++l) {
    const Positions coarse = randomSphere(static_cast<Index>(levels.graph(l).size()), 1);
    const Positions fine = coarse * hierarchy.levels[l - 1].prolongation.transpose();
    EXPECT_LT((levels.centroid(l, coarse) - levels.centroid(l - 1, fine)).norm(), 1e-12);
    EXPECT_LT((levels.interpolated(l - 1, coarse) - fine.colwise().normalized()).norm(), 1e-12);
  }
}

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
