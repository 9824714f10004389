#include "embedding_energy.h"

#include "embeddings.h"

namespace spherical_param::test {
namespace {

double dot(const Positions& x, const Positions& y) {
  return x.cwiseProduct(y).sum();
}

/// A vector in the tangent plane of each unit vector.
Positions randomTangent(const Positions& u, std::uint64_t seed) {
  const Positions v = withNoise(Positions::Zero(3, u.cols()), 1.0, seed);
  return v - u * u.cwiseProduct(v).colwise().sum().asDiagonal();
}

TEST(EmbeddingEnergy, DerivativesAgreeWithDifferences) {
  const Cloud cloud = dentedCloud(60);
  EmbeddingEnergy energy(cloud.graph, 1);
  energy.addBarrier(randomSphere(60, 8));
  const Positions u = randomSphere(60, 100);  // with another seed than the tangents
  Positions gradient;
  energy.gradient(u, gradient);
  const double scale = energy.value(u);
  constexpr double h = 1e-4;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Positions step = randomTangent(u, seed);
    const double forward = energy.value((u + h * step).colwise().normalized());
    const double backward = energy.value((u - h * step).colwise().normalized());
    EXPECT_NEAR((forward - backward) / (2.0 * h), dot(gradient, step), 1e-5 * scale);

    // To second order the normalised path is a geodesic.
    Positions product;
    energy.multiplyHessian(u, step, product);
    EXPECT_NEAR((forward - 2.0 * energy.value(u) + backward) / (h * h), dot(step, product),
                1e-4 * scale);
    EXPECT_LT(u.cwiseProduct(product).colwise().sum().norm(), 1e-12 * product.norm());
    const Positions other = randomTangent(u, 10 + seed);
    Positions other_product;
    energy.multiplyHessian(u, other, other_product);
    EXPECT_NEAR(dot(other, product), dot(step, other_product), 1e-12 * product.norm());
  }
}

}  // namespace
}  // namespace spherical_param::test
