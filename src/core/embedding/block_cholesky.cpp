#include "block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <numeric>

namespace spherical_param::internal {
namespace {

/// Nodes in an order that leaves few entries in L (P. R. Amestoy, T. A. Davis and I. S. Duff: "An
/// Approximate Minimum Degree Ordering Algorithm", 1996).
std::vector<Index> minimumDegreeOrder(const BlockMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.size());
  Eigen::SparseMatrix<double, Eigen::ColMajor, Index> pattern(n, n);
  pattern.resizeNonZeros(static_cast<Eigen::Index>(matrix.columns.size()));
  std::transform(matrix.offsets.begin(), matrix.offsets.end(), pattern.outerIndexPtr(),
                 [](std::size_t offset) { return static_cast<Index>(offset); });
  std::copy(matrix.columns.begin(), matrix.columns.end(), pattern.innerIndexPtr());
  std::fill_n(pattern.valuePtr(), matrix.columns.size(), 1.0);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Eigen::AMDOrdering<Index>()(pattern, order);
  return {order.indices().data(), order.indices().data() + n};
}

/// A diagonal block, raised; 1 where a node has no stiffness.
Eigen::Matrix2d raised(Eigen::Matrix2d block) {
  constexpr double shift = 1e-11;
  for (Eigen::Index k = 0; k < 2; ++k)
    block(k, k) = block(k, k) > 0.0 ? block(k, k) * (1.0 + shift) : 1.0;
  return block;
}

/// The inverse of a symmetric block by its own L D L^T, which is that of its two unknowns one after
/// the other; 0 in directions without stiffness.
Eigen::Matrix2d inverted(const Eigen::Matrix2d& block) {
  const double first = block(0, 0);
  const double ratio = first != 0.0 ? block(1, 0) / first : 0.0;
  const double second = block(1, 1) - ratio * block(1, 0);
  const double inverse_first = first != 0.0 ? 1.0 / first : 0.0;
  const double inverse_second = second != 0.0 ? 1.0 / second : 0.0;
  Eigen::Matrix2d result;
  result << inverse_first + ratio * ratio * inverse_second, -ratio * inverse_second,
      -ratio * inverse_second, inverse_second;
  return result;
}

}  // namespace

void BlockCholesky::compute(const BlockMatrix& matrix) {
  if (node_of_row_.size() != matrix.size())
    analyze(matrix);
  factorize(matrix);
}

void BlockCholesky::analyze(const BlockMatrix& matrix) {
  const std::size_t n = matrix.size();
  node_of_row_ = minimumDegreeOrder(matrix);
  row_of_node_.resize(n);
  for (std::size_t k = 0; k < n; ++k)
    row_of_node_[static_cast<std::size_t>(node_of_row_[k])] = static_cast<Index>(k);
  // The columns of row k are those of the matrix and all on the paths from them to k in the
  // elimination tree.
  std::vector<Index> parent(n, -1);
  std::vector<Index> visited(n, -1);
  std::vector<Index> path;
  column_offsets_.assign(n + 1, 0);
  row_offsets_.assign(1, 0);
  row_columns_.clear();
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = static_cast<Index>(k);
    visited[k] = row;
    const std::size_t first = row_columns_.size();
    const auto node = static_cast<std::size_t>(node_of_row_[k]);
    for (std::size_t e = matrix.offsets[node]; e < matrix.offsets[node + 1]; ++e) {
      Index i = row_of_node_[static_cast<std::size_t>(matrix.columns[e])];
      if (i > row)
        continue;
      path.clear();
      while (visited[static_cast<std::size_t>(i)] != row) {
        visited[static_cast<std::size_t>(i)] = row;
        path.push_back(i);
        Index& above = parent[static_cast<std::size_t>(i)];
        if (above < 0)
          above = row;
        i = above;
      }
      row_columns_.insert(row_columns_.end(), path.begin(), path.end());
    }
    // Ancestors have higher numbers.
    std::sort(row_columns_.begin() + static_cast<std::ptrdiff_t>(first), row_columns_.end());
    for (std::size_t c = first; c < row_columns_.size(); ++c)
      ++column_offsets_[static_cast<std::size_t>(row_columns_[c]) + 1];
    row_offsets_.push_back(row_columns_.size());
  }
  std::partial_sum(column_offsets_.begin(), column_offsets_.end(), column_offsets_.begin());
  rows_.resize(row_columns_.size());
  entries_.resize(row_columns_.size());
  inverse_pivots_.resize(n);
  row_.resize(n);
  permuted_.resize(n);
  column_ends_.assign(column_offsets_.begin(), column_offsets_.end() - 1);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t c = row_offsets_[k]; c < row_offsets_[k + 1]; ++c)
      rows_[column_ends_[static_cast<std::size_t>(row_columns_[c])]++] = static_cast<Index>(k);
}

void BlockCholesky::factorize(const BlockMatrix& matrix) {
  const std::size_t n = matrix.size();
  std::copy(column_offsets_.begin(), column_offsets_.end() - 1, column_ends_.begin());
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t c = row_offsets_[k]; c < row_offsets_[k + 1]; ++c)
      row_[static_cast<std::size_t>(row_columns_[c])].setZero();
    Eigen::Matrix2d pivot = Eigen::Matrix2d::Zero();
    const auto node = static_cast<std::size_t>(node_of_row_[k]);
    for (std::size_t e = matrix.offsets[node]; e < matrix.offsets[node + 1]; ++e) {
      const auto i =
          static_cast<std::size_t>(row_of_node_[static_cast<std::size_t>(matrix.columns[e])]);
      if (i < k)
        row_[i] = matrix.blocks[e];
      else if (i == k)
        pivot = raised(matrix.blocks[e]);
    }
    // Row k of L D, column by column: each of them contributes to those of the rows that it has.
    for (std::size_t c = row_offsets_[k]; c < row_offsets_[k + 1]; ++c) {
      const auto j = static_cast<std::size_t>(row_columns_[c]);
      const Eigen::Matrix2d scaled = row_[j];
      const std::size_t end = column_ends_[j]++;
      for (std::size_t e = column_offsets_[j]; e < end; ++e)
        row_[static_cast<std::size_t>(rows_[e])] -= scaled.lazyProduct(entries_[e]);
      entries_[end] = inverse_pivots_[j].lazyProduct(scaled.transpose());
      pivot -= scaled.lazyProduct(entries_[end]);
    }
    inverse_pivots_[k] = inverted(pivot);
  }
}

void BlockCholesky::solve(const TangentVector& b, TangentVector& x) {
  const std::size_t n = node_of_row_.size();
  for (std::size_t k = 0; k < n; ++k)
    permuted_[k] = b.segment<2>(2 * static_cast<Eigen::Index>(node_of_row_[k]));
  for (std::size_t j = 0; j < n; ++j) {
    const Eigen::Vector2d value = permuted_[j];
    for (std::size_t e = column_offsets_[j]; e < column_offsets_[j + 1]; ++e)
      permuted_[static_cast<std::size_t>(rows_[e])] -= entries_[e].transpose() * value;
  }
  x.resize(b.size());
  for (std::size_t j = n; j-- > 0;) {
    Eigen::Vector2d value = inverse_pivots_[j] * permuted_[j];
    for (std::size_t e = column_offsets_[j]; e < column_offsets_[j + 1]; ++e)
      value -= entries_[e] * permuted_[static_cast<std::size_t>(rows_[e])];
    permuted_[j] = value;
    x.segment<2>(2 * static_cast<Eigen::Index>(node_of_row_[j])) = value;
  }
}

}  // namespace spherical_param::internal
