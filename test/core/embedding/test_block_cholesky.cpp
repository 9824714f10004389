#include "block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <set>
#include <vector>

namespace spherical_param::internal {
namespace {

/// A ring of nodes with some chords: which blocks there are.
std::vector<std::set<Index>> ringWithChords(Index n) {
  std::vector<std::set<Index>> columns(static_cast<std::size_t>(n));
  const auto join = [&](Index i, Index j) {
    columns[static_cast<std::size_t>(i)].insert(j);
    columns[static_cast<std::size_t>(j)].insert(i);
  };
  for (Index i = 0; i < n; ++i) {
    join(i, i);
    join(i, (i + 1) % n);
    if (i % 3 == 0)
      join(i, (i * i + n / 2) % n);
  }
  return columns;
}

/// A^T A + 1 has the blocks of A^T A: here any symmetric one with a dominant diagonal.
Eigen::MatrixXd randomSymmetric(const std::vector<std::set<Index>>& columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (const Index j : columns[static_cast<std::size_t>(i)])
      if (j <= i) {
        Eigen::Matrix2d block;
        block << uniform(random), uniform(random), uniform(random), uniform(random);
        if (i == j)
          block = (block + block.transpose() + 20.0 * Eigen::Matrix2d::Identity()).eval();
        dense.block<2, 2>(2 * i, 2 * j) = block;
        dense.block<2, 2>(2 * j, 2 * i) = block.transpose();
      }
  return dense;
}

BlockMatrix blocksOf(const Eigen::MatrixXd& dense, const std::vector<std::set<Index>>& columns) {
  BlockMatrix matrix;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (const Index j : columns[i]) {
      matrix.columns.push_back(j);
      matrix.blocks.emplace_back(dense.block<2, 2>(2 * static_cast<Eigen::Index>(i), 2 * j));
    }
    matrix.offsets.push_back(matrix.columns.size());
  }
  return matrix;
}

TEST(BlockCholesky, SolutionIsThatOfADenseSolver) {
  for (const Index n : {2, 3, 7, 40}) {
    const std::vector<std::set<Index>> columns = ringWithChords(n);
    BlockCholesky cholesky;
    // The second matrix has the pattern of the first, which is kept.
    for (const std::uint64_t seed : {1U, 2U}) {
      const Eigen::MatrixXd dense = randomSymmetric(columns, seed);
      cholesky.compute(blocksOf(dense, columns));
      const TangentVector b = TangentVector::LinSpaced(2 * n, -1.0, 2.0);
      TangentVector x;
      cholesky.solve(b, x);
      // The diagonal is raised by a fraction of 1e-11, and the condition is below 10.
      EXPECT_LE((x - dense.ldlt().solve(b)).norm(), 1e-9 * b.norm()) << n;
    }
  }
}

TEST(BlockCholesky, NodesWithoutStiffnessKeepTheirRightSide) {
  // Node 1 hangs on nothing: its unknowns are those of the unit matrix.
  std::vector<std::set<Index>> columns = {{0, 2}, {1}, {0, 2}};
  Eigen::MatrixXd dense = randomSymmetric(columns, 3);
  dense.block<2, 2>(2, 2).setZero();
  BlockCholesky cholesky;
  cholesky.compute(blocksOf(dense, columns));
  TangentVector b(6);
  b << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  TangentVector x;
  cholesky.solve(b, x);
  EXPECT_EQ(x[2], 3.0);
  EXPECT_EQ(x[3], 4.0);
  dense.block<2, 2>(2, 2).setIdentity();
  EXPECT_LE((x - dense.ldlt().solve(b)).norm(), 1e-9 * b.norm());
}

TEST(BlockCholesky, SingularDirectionsStayFinite) {
  // Two nodes with the stiffness of their difference alone: singular for all that moves both.
  const std::vector<std::set<Index>> columns = {{0, 1}, {0, 1}};
  Eigen::MatrixXd dense(4, 4);
  dense << 1.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0;
  BlockCholesky cholesky;
  cholesky.compute(blocksOf(dense, columns));
  TangentVector b(4);
  b << 1.0, 2.0, -1.0, -2.0;  // in the range of the matrix
  TangentVector x;
  cholesky.solve(b, x);
  ASSERT_TRUE(x.allFinite());
  // The raised diagonal takes a fraction of 1e-11, and what is singular magnifies rounding by 1e11.
  EXPECT_LE((dense * x - b).norm(), 1e-4);
}

}  // namespace
}  // namespace spherical_param::internal
