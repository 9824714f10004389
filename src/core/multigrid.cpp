#include "core/multigrid.h"

#include "core/parallel.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <utility>

namespace spherical_param::internal {
namespace {

Eigen::Vector2d entry(const TangentVector& x, std::size_t i) {
  return x.segment<2>(2 * static_cast<Eigen::Index>(i));
}

/// Prolongation of tangent vectors: those of the seeds, turned into the tangent plane of the node.
BlockMatrix prolongationBlocks(const Eigen::SparseMatrix<double, Eigen::RowMajor, Index>& weights,
                               const std::vector<TangentBasis>& fine,
                               const std::vector<TangentBasis>& coarse) {
  BlockMatrix result;
  const auto n = static_cast<std::size_t>(weights.rows());
  const auto entries = static_cast<std::size_t>(weights.nonZeros());
  result.offsets.resize(n + 1);
  result.columns.assign(weights.innerIndexPtr(), weights.innerIndexPtr() + entries);
  result.blocks.resize(entries);
  for (std::size_t i = 0; i < n; ++i) {
    result.offsets[i + 1] = static_cast<std::size_t>(weights.outerIndexPtr()[i + 1]);
    for (std::size_t e = result.offsets[i]; e < result.offsets[i + 1]; ++e)
      result.blocks[e] =
          weights.valuePtr()[e] *
          (fine[i].transpose() * coarse[static_cast<std::size_t>(result.columns[e])]);
  }
  return result;
}

BlockMatrix transposed(const BlockMatrix& matrix, std::size_t columns) {
  BlockMatrix result;
  result.offsets.assign(columns + 1, 0);
  for (const Index column : matrix.columns)
    ++result.offsets[static_cast<std::size_t>(column) + 1];
  for (std::size_t c = 0; c < columns; ++c)
    result.offsets[c + 1] += result.offsets[c];
  result.columns.resize(matrix.columns.size());
  result.blocks.resize(matrix.blocks.size());
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e) {
      const std::size_t place = next[static_cast<std::size_t>(matrix.columns[e])]++;
      result.columns[place] = static_cast<Index>(i);
      result.blocks[place] = matrix.blocks[e].transpose();
    }
  return result;
}

/// Rows of restriction * matrix * prolongation, one after the other.
class GalerkinRows {
public:
  GalerkinRows(const BlockMatrix& restriction, const BlockMatrix& matrix,
               const BlockMatrix& prolongation)
      : restriction_(restriction), matrix_(matrix), prolongation_(prolongation),
        row_(restriction.size()), stamp_(restriction.size(), -1) {}

  void append(std::size_t c, BlockMatrix& result) {
    columns_.clear();
    for (std::size_t r = restriction_.offsets[c]; r < restriction_.offsets[c + 1]; ++r) {
      const auto i = static_cast<std::size_t>(restriction_.columns[r]);
      for (std::size_t e = matrix_.offsets[i]; e < matrix_.offsets[i + 1]; ++e)
        add(c, restriction_.blocks[r] * matrix_.blocks[e],
            static_cast<std::size_t>(matrix_.columns[e]));
    }
    std::sort(columns_.begin(), columns_.end());
    for (const Index column : columns_) {
      result.columns.push_back(column);
      result.blocks.push_back(row_[static_cast<std::size_t>(column)]);
    }
    result.offsets.push_back(result.columns.size());
  }

private:
  /// left * row j of the prolongation
  void add(std::size_t c, const Eigen::Matrix2d& left, std::size_t j) {
    for (std::size_t p = prolongation_.offsets[j]; p < prolongation_.offsets[j + 1]; ++p) {
      const auto column = static_cast<std::size_t>(prolongation_.columns[p]);
      if (stamp_[column] == static_cast<Index>(c)) {
        row_[column] += left * prolongation_.blocks[p];
      } else {
        stamp_[column] = static_cast<Index>(c);
        columns_.push_back(static_cast<Index>(column));
        row_[column] = left * prolongation_.blocks[p];
      }
    }
  }

  const BlockMatrix& restriction_;
  const BlockMatrix& matrix_;
  const BlockMatrix& prolongation_;
  std::vector<Eigen::Matrix2d> row_;
  std::vector<Index> stamp_;  ///< row that last wrote to each column
  std::vector<Index> columns_;
};

/// restriction * matrix * prolongation
BlockMatrix galerkinProduct(const BlockMatrix& restriction, const BlockMatrix& matrix,
                            const BlockMatrix& prolongation) {
  BlockMatrix result;
  GalerkinRows rows(restriction, matrix, prolongation);
  result.offsets.reserve(restriction.offsets.size());
  for (std::size_t c = 0; c < restriction.size(); ++c)
    rows.append(c, result);
  return result;
}

std::vector<Eigen::Matrix2d> invertedDiagonal(const BlockMatrix& matrix) {
  std::vector<Eigen::Matrix2d> result(matrix.size());
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
      if (static_cast<std::size_t>(matrix.columns[e]) == i) {
        Eigen::Matrix2d block = matrix.blocks[e];
        // A node whose neighbours are all at its own place has no stiffness: it stays.
        constexpr double shift = 1e-12;
        const double trace = block.trace();
        if (trace > 0.0 && std::isfinite(trace)) {
          block.diagonal().array() += shift * trace;
          result[i] = block.inverse();
        } else {
          result[i].setZero();
        }
      }
  return result;
}

/// y = A^T x
void multiplyTransposed(const BlockMatrix& matrix, std::size_t columns, const TangentVector& x,
                        TangentVector& y) {
  y.setZero(2 * static_cast<Eigen::Index>(columns));
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
      y.segment<2>(2 * static_cast<Eigen::Index>(matrix.columns[e])) +=
          matrix.blocks[e].transpose() * entry(x, i);
}

/// One Gauss-Seidel sweep for matrix x = b.
template <bool Forward>
void smooth(const BlockMatrix& matrix, const std::vector<Eigen::Matrix2d>& inverse_diagonal,
            const TangentVector& b, TangentVector& x) {
  const std::size_t n = matrix.size();
  for (std::size_t step = 0; step < n; ++step) {
    const std::size_t i = Forward ? step : n - 1 - step;
    Eigen::Vector2d rest = entry(b, i);
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
      rest -= matrix.blocks[e] * entry(x, static_cast<std::size_t>(matrix.columns[e]));
    x.segment<2>(2 * static_cast<Eigen::Index>(i)) += inverse_diagonal[i] * rest;
  }
}

Eigen::SparseMatrix<double> scalarMatrix(const BlockMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.size());
  Eigen::SparseMatrix<double> result(2 * n, 2 * n);
  // The matrix is symmetric: its rows are its columns.
  result.reserve(4 * static_cast<Eigen::Index>(matrix.blocks.size()));
  constexpr double shift = 1e-11;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (Eigen::Index k = 0; k < 2; ++k) {
      const Eigen::Index column = 2 * static_cast<Eigen::Index>(i) + k;
      result.startVec(column);
      for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
        for (Eigen::Index l = 0; l < 2; ++l) {
          const Eigen::Index row = 2 * static_cast<Eigen::Index>(matrix.columns[e]) + l;
          double value = matrix.blocks[e](k, l);
          if (row == column)
            // Beyond rounding: the matrix is singular, or nearly so, for rotations.
            value = value > 0.0 ? value * (1.0 + shift) : 1.0;
          result.insertBack(row, column) = value;
        }
    }
  result.finalize();
  return result;
}

}  // namespace

void multiply(const BlockMatrix& matrix, const TangentVector& x, TangentVector& y, int threads) {
  y.resize(2 * static_cast<Eigen::Index>(matrix.size()));
  forEachBlock(matrix.size(), threadCount(threads, matrix.size(), kShortPassThreshold),
               [&](std::size_t, std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   Eigen::Vector2d sum = Eigen::Vector2d::Zero();
                   for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e)
                     sum +=
                         matrix.blocks[e] * entry(x, static_cast<std::size_t>(matrix.columns[e]));
                   y.segment<2>(2 * static_cast<Eigen::Index>(i)) = sum;
                 }
               });
}

MultigridPreconditioner::MultigridPreconditioner(const GraphHierarchy& hierarchy, std::size_t first,
                                                 int threads)
    : hierarchy_(hierarchy), first_(first), threads_(threads),
      levels_(hierarchy.levels.size() - first + 1) {}

void MultigridPreconditioner::compute(const BlockMatrix& matrix,
                                      const std::vector<TangentBasis>& bases) {
  std::vector<TangentBasis> coarser;  // bases of the level at hand, below the finest
  const BlockMatrix* current = &matrix;
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    Level& level = levels_[l];
    const HierarchyLevel& next = hierarchy_.levels[first_ + l];
    const std::vector<TangentBasis>& fine = l == 0 ? bases : coarser;
    std::vector<TangentBasis> coarse(next.seeds.size());
    for (std::size_t s = 0; s < coarse.size(); ++s)
      coarse[s] = fine[static_cast<std::size_t>(next.seeds[s])];
    level.matrix = current;
    level.inverse_diagonal = invertedDiagonal(*current);
    level.prolongation = prolongationBlocks(next.prolongation, fine, coarse);
    levels_[l + 1].galerkin = galerkinProduct(transposed(level.prolongation, coarse.size()),
                                              *current, level.prolongation);
    current = &levels_[l + 1].galerkin;
    coarser = std::move(coarse);
  }
  levels_.back().matrix = current;
  const Eigen::SparseMatrix<double> scalar = scalarMatrix(*current);
  if (!analyzed_)
    coarsest_.analyzePattern(scalar);
  analyzed_ = true;
  coarsest_.factorize(scalar);
}

void MultigridPreconditioner::apply(const TangentVector& b, TangentVector& x) {
  cycle(0, b, x);
}

void MultigridPreconditioner::cycle(std::size_t l, const TangentVector& b, TangentVector& x) {
  Level& level = levels_[l];
  if (l + 1 == levels_.size()) {
    x = coarsest_.solve(b);
    return;
  }
  Level& next = levels_[l + 1];
  x.setZero(b.size());
  smooth<true>(*level.matrix, level.inverse_diagonal, b, x);
  multiply(*level.matrix, x, level.residual, threads_);
  level.residual = b - level.residual;
  multiplyTransposed(level.prolongation, next.matrix->size(), level.residual, next.right_side);
  cycle(l + 1, next.right_side, next.solution);
  multiply(level.prolongation, next.solution, level.residual, threads_);
  x += level.residual;
  smooth<false>(*level.matrix, level.inverse_diagonal, b, x);
}

LinearSolution conjugateGradients(const EmbeddingEnergy::Hessian& hessian,
                                  const std::vector<TangentBasis>& bases,
                                  MultigridPreconditioner& preconditioner,
                                  const TangentVector& gradient, const LinearTolerance& tolerance) {
  const auto apply = [&](const TangentVector& x, TangentVector& y) {
    multiply(hessian.matrix, x, y, preconditioner.threads());
    for (Eigen::Index i = 0; i < hessian.curvature.size(); ++i)
      y.segment<2>(2 * i) -= hessian.curvature[i] * x.segment<2>(2 * i);
    if (hessian.masses.size() == 0)
      return;
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < bases.size(); ++i)
      centroid += hessian.masses[static_cast<Eigen::Index>(i)] * bases[i] * entry(x, i);
    const Eigen::Vector3d pull = hessian.barrier * centroid;
    for (std::size_t i = 0; i < bases.size(); ++i) {
      const auto place = static_cast<Eigen::Index>(i);
      y.segment<2>(2 * place) += hessian.masses[place] * (bases[i].transpose() * pull);
    }
  };

  LinearSolution solution;
  solution.x.setZero(gradient.size());
  TangentVector residual = -gradient;
  TangentVector preconditioned;
  preconditioner.apply(residual, preconditioned);
  TangentVector direction = preconditioned;
  TangentVector product;
  double square = residual.dot(preconditioned);
  const double goal = tolerance.reduction * tolerance.reduction * square;
  while (solution.iterations < tolerance.most_iterations && square > goal) {
    apply(direction, product);
    const double curvature = direction.dot(product);
    if (!(curvature > 0.0)) {
      if (solution.iterations == 0)
        solution.x = direction;
      break;
    }
    const double step = square / curvature;
    solution.x += step * direction;
    residual -= step * product;
    ++solution.iterations;
    preconditioner.apply(residual, preconditioned);
    const double next_square = residual.dot(preconditioned);
    direction = preconditioned + (next_square / square) * direction;
    square = next_square;
  }
  for (int refinement = 0; refinement < tolerance.refinements; ++refinement) {
    apply(solution.x, product);
    residual = -gradient - product;
    preconditioner.apply(residual, preconditioned);
    solution.x += preconditioned;
  }
  return solution;
}

}  // namespace spherical_param::internal
