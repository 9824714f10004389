#include "laplacian_cycle.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(LaplacianCycle, IsSymmetricAndWithoutCoarserLevelsExact) {
  const Cloud cloud = dentedCloud(1000);
  const SparseRows laplacian =
      EmbeddingEnergy(cloud.graph, 1).laplacian(projectFromCentroid(cloud.points));
  const Positions a = randomCube(1000, 1);
  const Positions b = randomCube(1000, 2);
  for (const GraphHierarchy& levels :
       {GraphHierarchy(), buildGraphHierarchy(cloud.graph, 1, 100)}) {
    LaplacianCycle cycle(levels, 0);
    cycle.compute(laplacian);
    const double product = cycle.apply(a).cwiseProduct(b).sum();
    EXPECT_NEAR(product, cycle.apply(b).cwiseProduct(a).sum(), 1e-9 * std::abs(product));
    const double error = (cycle.apply(a * laplacian) - a).norm() / a.norm();
    EXPECT_LT(error, levels.levels.empty() ? 1e-8 : 0.5);
  }
}

TEST(LaplacianCycle, StepsDoNotGrowWithTheGraph) {
  const auto steps = [](Index n) {
    const Cloud cloud = dentedCloud(n);
    return solve(cloud.graph, converging(1e-10)).report.levels.front().linear_iterations;
  };
  const int small = steps(3000);
  EXPECT_GT(small, 0);
  EXPECT_LE(steps(24000), small + small / 2);
}

}  // namespace
}  // namespace spherical_param::test
