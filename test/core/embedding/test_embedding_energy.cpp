#include "embedding_energy.h"

#include "embeddings.h"
#include "multigrid.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using namespace test;

void expectDerivativesOfDifferences(bool barrier) {
  const Cloud cloud = dentedCloud(60);
  EmbeddingEnergy energy(cloud.graph, 1);
  if (barrier)
    energy.addBarrier(randomSphere(60, 8));
  const Positions u = randomSphere(60, 3);
  const std::vector<TangentBasis> bases = internal::tangentBases(u);
  Positions gradient;
  energy.gradient(u, gradient);
  EmbeddingEnergy::Hessian hessian;
  energy.hessian(u, bases, hessian);
  const double scale = energy.value(u);
  constexpr double h = 1e-4;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const TangentVector step = randomTangent(60, seed);
    double slope = 0.0;
    for (Eigen::Index i = 0; i < 60; ++i)
      slope += gradient.col(i).dot(bases[static_cast<std::size_t>(i)] * step.segment<2>(2 * i));
    const double forward = energy.value(moved(u, bases, step, h));
    const double backward = energy.value(moved(u, bases, step, -h));
    EXPECT_NEAR((forward - backward) / (2.0 * h), slope, 1e-5 * scale);

    // To second order the normalised path is a geodesic.
    TangentVector product;
    internal::multiply(hessian.matrix, step, product, 1);
    double second = step.dot(product);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < 60; ++i) {
      second -= hessian.curvature[i] * step.segment<2>(2 * i).squaredNorm();
      if (barrier)
        mean += hessian.masses[i] * bases[static_cast<std::size_t>(i)] * step.segment<2>(2 * i);
    }
    if (barrier)
      second += mean.dot(hessian.barrier * mean);
    EXPECT_NEAR((forward - 2.0 * energy.value(u) + backward) / (h * h), second, 1e-4 * scale);
  }
}

TEST(EmbeddingEnergy, DerivativesAgreeWithDifferences) {
  expectDerivativesOfDifferences(false);
  expectDerivativesOfDifferences(true);
}

}  // namespace
}  // namespace spherical_param
