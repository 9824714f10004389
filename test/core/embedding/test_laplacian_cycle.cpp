#include "laplacian_cycle.h"

#include "embeddings.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using namespace test;

/// The same V-cycle with dense matrices: x such that cycle(matrix, level) b = x.
Eigen::MatrixXd denseCycle(const GraphHierarchy& hierarchy, std::size_t level,
                           const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& b) {
  if (level == hierarchy.levels.size())
    return matrix.ldlt().solve(b);
  const Eigen::MatrixXd prolongation = hierarchy.levels[level].prolongation;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(b.rows(), b.cols());
  const auto solve_row = [&](Eigen::Index i) {
    x.row(i) += (b.row(i) - matrix.row(i) * x) / matrix(i, i);
  };
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    solve_row(i);
  x += prolongation * denseCycle(hierarchy, level + 1,
                                 prolongation.transpose() * matrix * prolongation,
                                 prolongation.transpose() * (b - matrix * x));
  for (Eigen::Index i = b.rows(); i-- > 0;)
    solve_row(i);
  return x;
}

TEST(LaplacianCycle, IsTheCycleOfDenseMatricesForEachMatrixInTurn) {
  const Cloud cloud = dentedCloud(300);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 10);
  ASSERT_GE(hierarchy.levels.size(), 2U);
  Positions u = solve(cloud.graph).directions;
  internal::LaplacianCycle cycle(hierarchy, 0);
  internal::LaplacianCycle direct(hierarchy, hierarchy.levels.size());
  for (unsigned turn = 0; turn < 3; ++turn) {
    const internal::LaplacianCycle::Matrix laplacian = EmbeddingEnergy(cloud.graph, 1).laplacian(u);
    const Eigen::MatrixXd matrix = laplacian;
    const Positions b = randomTangent(u, turn);
    cycle.compute(laplacian);
    const Eigen::MatrixXd expected = denseCycle(hierarchy, 0, matrix, b.transpose());
    EXPECT_LT((cycle.apply(b).transpose() - expected).norm(), 1e-8 * expected.norm());
    direct.compute(laplacian);
    EXPECT_LT((direct.apply(b) * matrix - b).norm(), 1e-8 * b.norm());
    u = moved(u, randomTangent(u, 10 + turn), 0.02);
  }
}

TEST(LaplacianCycle, SingularDirectionsStayFinite) {
  // Two nodes with the stiffness of their difference alone: singular for all that moves both.
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1.0, -1.0, -1.0, 1.0;
  Positions b(3, 2);
  b << 1.0, -1.0, 2.0, -2.0, 0.0, 0.0;  // in the range of the matrix
  internal::LaplacianCycle direct(GraphHierarchy(), 0);
  direct.compute(matrix.sparseView());
  const Positions x = direct.apply(b);
  ASSERT_TRUE(x.allFinite());
  // The raised diagonal takes a fraction of 1e-11, and what is singular magnifies rounding by 1e11.
  EXPECT_LE((x * matrix - b).norm(), 1e-4);
}

}  // namespace
}  // namespace spherical_param
