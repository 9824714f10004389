#pragma once

#include "block_matrix.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Sparse Cholesky factorisation L D L^T of a symmetric block matrix, up-looking (T. A. Davis,
/// "Algorithm 849: A concise sparse Cholesky factorization package", 2005), in blocks: one index
/// for four entries, and a minimum-degree order of nodes, not of unknowns. The diagonal is raised
/// slightly because the matrix is (nearly) singular for rotations.
class BlockCholesky {
public:
  /// \param matrix symmetric, with all diagonal blocks. Order and pattern of L are found for the
  /// first
  ///               matrix; later ones must have the same pattern.
  void compute(const BlockMatrix& matrix);

  /// x = matrix^-1 b
  void solve(const TangentVector& b, TangentVector& x);

private:
  void analyze(const BlockMatrix& matrix);
  void factorize(const BlockMatrix& matrix);

  std::vector<Index> node_of_row_;
  std::vector<Index> row_of_node_;
  /// Columns of each row of L, below the diagonal, each before those that it contributes to.
  std::vector<std::size_t> row_offsets_;
  std::vector<Index> row_columns_;
  std::vector<std::size_t> column_offsets_;
  std::vector<Index> rows_;               ///< of the entries of each column of L, ascending
  std::vector<Eigen::Matrix2d> entries_;  ///< transposed blocks of L
  std::vector<Eigen::Matrix2d> inverse_pivots_;
  // Working memory: the row at hand, the end of each column, a permuted right side.
  std::vector<Eigen::Matrix2d> row_;
  std::vector<std::size_t> column_ends_;
  std::vector<Eigen::Vector2d> permuted_;
};

}  // namespace spherical_param::internal
