#include "spherical_param/map/spherical_harmonics.h"

#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::kPi;

/// P_l by the recurrence of its definition.
double legendre(int degree, double z) {
  double before = 0.0;
  double value = 1.0;
  for (int l = 1; l <= degree; ++l) {
    const double next = ((2.0 * l - 1.0) * z * value - (l - 1.0) * before) / l;
    before = value;
    value = next;
  }
  return value;
}

TEST(SphericalHarmonics, LowDegreesAreThePolynomialsOfTheBooks) {
  // Signs, order and the axis of each m; the addition theorem has none of these.
  const Positions directions = test::randomSphere(20, 1);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const double x = directions(0, i);
    const double y = directions(1, i);
    const double z = directions(2, i);
    Eigen::VectorXd expected(9);
    expected << 0.5 * std::sqrt(1.0 / kPi), std::sqrt(0.75 / kPi) * y, std::sqrt(0.75 / kPi) * z,
        std::sqrt(0.75 / kPi) * x, 0.5 * std::sqrt(15.0 / kPi) * x * y,
        0.5 * std::sqrt(15.0 / kPi) * y * z, 0.25 * std::sqrt(5.0 / kPi) * (3.0 * z * z - 1.0),
        0.5 * std::sqrt(15.0 / kPi) * x * z, 0.25 * std::sqrt(15.0 / kPi) * (x * x - y * y);
    for (const double length : {1.0, 1e200, 1e-200})
      EXPECT_LT((sphericalHarmonicsAt(length * directions.col(i), 2) - expected).norm(), 1e-14);
  }
}

TEST(SphericalHarmonics, ObeyTheAdditionTheoremUpToTheHighestDegree) {
  // As only orthonormal ones do.
  const int degree = 512;
  std::vector<Vector3d> directions{Vector3d::UnitZ(), Vector3d::UnitX(),
                                   Vector3d(1e-12, 0.0, -1.0).normalized(),
                                   Vector3d(0.3, -0.5, 0.7).normalized()};
  std::vector<Eigen::VectorXd> values;
  for (const Vector3d& u : directions)
    values.push_back(sphericalHarmonicsAt(u, degree));
  for (std::size_t i = 0; i < directions.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      for (int l = 0; l <= degree; ++l) {
        const double sum =
            values[i].segment(l * l, 2 * l + 1).dot(values[j].segment(l * l, 2 * l + 1));
        const double expected =
            (2.0 * l + 1.0) / (4.0 * kPi) * legendre(l, directions[i].dot(directions[j]));
        // P_l changes by up to l (l + 1) / 2 times the rounding of u.w.
        ASSERT_NEAR(sum, expected, 1e-15 * (l + 1.0) * (l + 1.0) * (l + 1.0) / 4.0 + 1e-13);
      }
}

TEST(SphericalHarmonics, OfAShapeThatIsASeriesAreItsCoefficients) {
  SphericalHarmonics given;
  given.degree = 5;
  given.coefficients = 0.05 * test::randomSphere(36, 3);
  given.coefficients.col(0) << 5.0, -1.0, 2.0;
  given.coefficients(1, 1) = given.coefficients(2, 2) = given.coefficients(0, 3) = 2.0;
  const SphereSurface surface = test::surfaceOver(8000, [&](const Vector3d& u) {
    return Vector3d(evaluateSphericalHarmonics(given, u).col(0));
  });
  const SphericalHarmonics found = computeSphericalHarmonics(surface, 7);
  EXPECT_LT((found.coefficients.leftCols(36) - given.coefficients).cwiseAbs().maxCoeff(), 5e-3);
  EXPECT_LT(found.coefficients.rightCols(28).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT(found.rms_residual, 2e-3);
  // Too few terms leave what they cannot show: orthonormal ones, by Pythagoras.
  const SphericalHarmonics few = computeSphericalHarmonics(surface, 3);
  const double rest = std::sqrt(given.coefficients.rightCols(20).squaredNorm() / (4.0 * kPi));
  EXPECT_NEAR(few.rms_residual, rest, 0.01 * rest);
}

}  // namespace
}  // namespace spherical_param
