#include "tangent_basis.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

TEST(TangentBasis, IsOrthonormalAndRightHandedFromInside) {
  Positions directions = test::randomSphere(200, 1);
  directions.leftCols(6) << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  for (const Eigen::Vector3d u : directions.colwise()) {
    Eigen::Matrix3d axes;
    axes << tangentBasis(u).col(1), tangentBasis(u).col(0), -u;
    EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-15 * 10);
    EXPECT_GT(axes.determinant(), 0.0);
  }
}

}  // namespace
}  // namespace spherical_param::internal
