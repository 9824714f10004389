#include "quadric_fit.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// A 4 x 4 grid of distance 1 around (0, 0), at height 0.1 bend (x^2 + y^2) - depth.
Points bowl(double bend, double depth) {
  Points points;
  for (const double x : {-1.5, -0.5, 0.5, 1.5})
    for (const double y : {-1.5, -0.5, 0.5, 1.5})
      points.emplace_back(x, y, 0.1 * bend * (x * x + y * y) - depth);
  return points;
}
const std::vector<double> kEven(16, 1.0 / 16);

TEST(QuadricFit, OfAQuadricHasTheHeightOfTheOriginAboveIt) {
  QuadricFit fit;
  fit.fit(bowl(1.0, 0.7), kEven);
  EXPECT_NEAR(fit.height() * fit.normal().z(), 0.7, 1e-7);  // the ridge is 1e-9
  EXPECT_LT(fit.residual(), 1e-7);
  EXPECT_GT(fit.roundness(), 0.01);
  EXPECT_NEAR(fit.gap(), std::sqrt(0.5), 1e-12);
  fit.fit(bowl(0.0, 0.7), kEven);
  EXPECT_NEAR(fit.roundness(), 0.0, 1e-7);
  fit.fit(Points(5, {1.0, 2.0, 3.0}), std::vector<double>(5, 0.2));  // too few
  EXPECT_EQ(fit.normal(), Eigen::Vector3d::Zero());
  EXPECT_EQ(fit.height(), 0.0);
}

TEST(QuadricFit, LeverageIsTheVarianceOfTheHeightByIndependentErrors) {
  QuadricFit fit;
  double variance = 0.0;
  for (std::size_t k = 0; k < 16; ++k) {
    Points shifted = bowl(0.0, 0.0);
    shifted[k].z() += 1e-4;
    fit.fit(shifted, kEven);
    variance += 16.0 * std::pow(fit.height() / 1e-4, 2);  // of a sixteenth of the weight
  }
  fit.fit(bowl(0.0, 0.0), kEven);
  EXPECT_NEAR(fit.leverage(), variance, 1e-3 * variance);
}

}  // namespace
}  // namespace spherical_param::test
