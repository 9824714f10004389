#include "multigrid.h"

#include "embeddings.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using namespace test;

Eigen::MatrixXd dense(const internal::BlockMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
      result.block<2, 2>(2 * static_cast<Eigen::Index>(i), 2 * matrix.columns[e]) =
          matrix.blocks[e];
  return result;
}

/// The same V-cycle with dense matrices: x such that cycle(matrix, level) b = x.
Eigen::VectorXd denseCycle(const GraphHierarchy& hierarchy, std::size_t level,
                           const Eigen::MatrixXd& matrix, const std::vector<TangentBasis>& bases,
                           const Eigen::VectorXd& b) {
  if (level == hierarchy.levels.size())
    return matrix.ldlt().solve(b);
  const internal::HierarchyLevel& next = hierarchy.levels[level];
  const auto coarse = static_cast<Eigen::Index>(next.seeds.size());
  std::vector<TangentBasis> coarse_bases;
  for (const Index seed : next.seeds)
    coarse_bases.push_back(bases[static_cast<std::size_t>(seed)]);
  const Eigen::MatrixXd weights = next.prolongation;
  Eigen::MatrixXd prolongation(matrix.rows(), 2 * coarse);
  for (Eigen::Index i = 0; i < weights.rows(); ++i)
    for (Eigen::Index c = 0; c < coarse; ++c)
      prolongation.block<2, 2>(2 * i, 2 * c) = weights(i, c) *
                                               bases[static_cast<std::size_t>(i)].transpose() *
                                               coarse_bases[static_cast<std::size_t>(c)];
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  const auto solve_row = [&](Eigen::Index i) {
    const Eigen::Vector2d rest = b.segment<2>(2 * i) - matrix.middleRows<2>(2 * i) * x;
    x.segment<2>(2 * i) += matrix.block<2, 2>(2 * i, 2 * i).inverse() * rest;
  };
  for (Eigen::Index i = 0; i < weights.rows(); ++i)
    solve_row(i);
  x += prolongation * denseCycle(hierarchy, level + 1,
                                 prolongation.transpose() * matrix * prolongation, coarse_bases,
                                 prolongation.transpose() * (b - matrix * x));
  for (Eigen::Index i = weights.rows(); i-- > 0;)
    solve_row(i);
  return x;
}

TEST(MultigridPreconditioner, IsTheCycleOfDenseMatricesForEachMatrixInTurn) {
  const Cloud cloud = dentedCloud(300);
  const GraphHierarchy hierarchy = buildGraphHierarchy(cloud.graph, 1, 10);
  ASSERT_GE(hierarchy.levels.size(), 2U);
  Positions u = solve(cloud.graph).directions;
  internal::MultigridPreconditioner cycle(hierarchy, 0, 1);
  const GraphHierarchy none;
  internal::MultigridPreconditioner direct(none, 0, 1);
  for (unsigned turn = 0; turn < 3; ++turn) {
    const std::vector<TangentBasis> bases = internal::tangentBases(u);
    EmbeddingEnergy::Hessian hessian;
    EmbeddingEnergy(cloud.graph, 1).hessian(u, bases, hessian);
    // Well above the rotations, for which the matrix is nearly singular.
    for (std::size_t i = 0; i < hessian.matrix.size(); ++i)
      for (std::size_t e = hessian.matrix.offsets[i]; e < hessian.matrix.offsets[i + 1]; ++e)
        if (static_cast<std::size_t>(hessian.matrix.columns[e]) == i)
          hessian.matrix.blocks[e] *= 1.1;
    const Eigen::MatrixXd matrix = dense(hessian.matrix);
    const TangentVector b = randomTangent(300, turn);
    TangentVector x;
    cycle.compute(hessian.matrix, bases);
    cycle.apply(b, x);
    const Eigen::VectorXd expected = denseCycle(hierarchy, 0, matrix, bases, b);
    EXPECT_LT((x - expected).norm(), 1e-8 * expected.norm());
    direct.compute(hessian.matrix, bases);
    direct.apply(b, x);
    EXPECT_LT((matrix * x - b).norm(), 1e-8 * b.norm());
    u = moved(u, bases, randomTangent(300, 10 + turn), 0.02);
  }
}

}  // namespace
}  // namespace spherical_param
