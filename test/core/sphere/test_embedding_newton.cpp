#include "embedding_newton.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

TEST(EmbeddingNewton, ConvergesFasterThanLinearlyUnlessItCollapses) {
  const Cloud cloud = dentedCloud(500);
  const Positions start = projectFromCentroid(cloud.points);
  const EmbeddingEnergy energy(cloud.graph, 1);
  const GraphHierarchy none;
  LaplacianCycle solver(none, 0);
  std::size_t reports = 0;
  NewtonOptions options{1e-9, 1e-12, [&](double) { ++reports; }};
  Positions u = start;
  LevelReport report;
  const std::vector<double> residuals = minimizeByNewton(energy, solver, options, u, report);
  EXPECT_EQ(residuals.size(), reports);
  EXPECT_EQ(residuals.size(), static_cast<std::size_t>(report.newton_iterations) + 1);
  EXPECT_LE(residuals.back(), 1e-12);
  EXPECT_LT(residuals.back(), 1e-3 * residuals.rbegin()[1]);
  EXPECT_NEAR(meanTangentialLaplacian(cloud.graph, u, EdgeWeights::Adaptive), report.residual,
              1e-15);
  EXPECT_LT(energy.value(u), energy.value(start));

  options.collapses = [](const Positions&) { return true; };
  u = start;
  EXPECT_EQ(minimizeByNewton(energy, solver, options, u, report).size(), 1U);
  EXPECT_EQ(u, start);
}

}  // namespace
}  // namespace spherical_param::test
