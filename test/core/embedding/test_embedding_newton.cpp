#include "embedding_newton.h"

#include "embeddings.h"
#include "multigrid.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using namespace test;

TEST(MinimizeByNewton, EndsWhereNothingKeepsTheEmbeddingFromCollapsing) {
  const Cloud cloud = dentedCloud(300);
  Positions u = solve(cloud.graph).directions * 0.1;
  u.row(2).array() += 1.0;
  u.colwise().normalize();
  const EmbeddingEnergy energy(cloud.graph, kAdaptive, 1);
  const GraphHierarchy none;
  internal::NewtonOptions options;
  options.relative_tolerance = 1e-4;
  const auto steps = [&](double longest_mean) {
    internal::MultigridPreconditioner direct(none, 0, 1);
    options.longest_mean = longest_mean;
    Positions trial = u;
    const int iterations = minimizeByNewton(energy, direct, options, trial).iterations;
    EXPECT_GT(trial.rowwise().mean().norm(), 0.99);
    return iterations;
  };
  EXPECT_EQ(steps(0.99), 0);
  EXPECT_GT(steps(1.0), 10);
}

}  // namespace
}  // namespace spherical_param
