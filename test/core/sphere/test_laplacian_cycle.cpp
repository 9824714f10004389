#include "laplacian_cycle.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

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
