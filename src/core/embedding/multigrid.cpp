#include "multigrid.h"

#include "parallel.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spherical_param::internal {
namespace {

Eigen::Vector2d entry(const TangentVector& x, std::size_t i) {
  return x.segment<2>(2 * static_cast<Eigen::Index>(i));
}

void findDiagonal(const BlockMatrix& matrix, std::vector<std::size_t>& places) {
  places.resize(matrix.size());
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    const auto begin = matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[i]);
    const auto end = matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[i + 1]);
    const auto place = std::lower_bound(begin, end, static_cast<Index>(i));
    places[i] = static_cast<std::size_t>(place - matrix.columns.begin());
  }
}

Eigen::Matrix2d regularizedInverse(const Eigen::Matrix2d& block) {
  // A node whose neighbours are all at its own place has no stiffness: it stays.
  constexpr double shift = 1e-12;
  const double trace = block.trace();
  if (!(trace > 0.0 && std::isfinite(trace)))
    return Eigen::Matrix2d::Zero();
  Eigen::Matrix2d raised = block;
  raised.diagonal().array() += shift * trace;
  return raised.inverse();
}

/// rest - the blocks [begin, end) of the matrix * x
Eigen::Vector2d reduced(const BlockMatrix& matrix, std::size_t begin, std::size_t end,
                        const TangentVector& x, Eigen::Vector2d rest) {
  for (std::size_t e = begin; e < end; ++e)
    rest -= matrix.blocks[e] * entry(x, static_cast<std::size_t>(matrix.columns[e]));
  return rest;
}

/// Appends the columns of a row of a matrix that `stamp` does not yet have for this row.
///
/// \param stamp the row that last had each column.
void addColumns(Index row, const BlockMatrix& matrix, Index matrix_row, std::vector<Index>& stamp,
                std::vector<Index>& columns) {
  const auto r = static_cast<std::size_t>(matrix_row);
  for (std::size_t e = matrix.offsets[r]; e < matrix.offsets[r + 1]; ++e) {
    Index& last = stamp[static_cast<std::size_t>(matrix.columns[e])];
    if (last == row)
      continue;
    last = row;
    columns.push_back(matrix.columns[e]);
  }
}

/// One Gauss-Seidel sweep for matrix x = b from x = 0, and what it leaves: as each row is solved
/// when its turn comes, only what follows it in the matrix adds to its residual.
void smoothFromZero(const BlockMatrix& matrix, const std::vector<std::size_t>& diagonal,
                    const std::vector<Eigen::Matrix2d>& inverse_diagonal, const TangentVector& b,
                    TangentVector& x, TangentVector& residual, int threads) {
  const std::size_t n = matrix.size();
  x.resize(b.size());
  residual.resize(b.size());
  for (std::size_t i = 0; i < n; ++i)
    x.segment<2>(2 * static_cast<Eigen::Index>(i)) =
        inverse_diagonal[i] * reduced(matrix, matrix.offsets[i], diagonal[i], x, entry(b, i));
  forEachBlock(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      residual.segment<2>(2 * static_cast<Eigen::Index>(i)) =
          reduced(matrix, diagonal[i] + 1, matrix.offsets[i + 1], x, Eigen::Vector2d::Zero());
  });
}

/// One Gauss-Seidel sweep for matrix x = b, from the last row to the first.
void smoothBackward(const BlockMatrix& matrix, const std::vector<Eigen::Matrix2d>& inverse_diagonal,
                    const TangentVector& b, TangentVector& x) {
  for (std::size_t i = matrix.size(); i-- > 0;)
    x.segment<2>(2 * static_cast<Eigen::Index>(i)) +=
        inverse_diagonal[i] *
        reduced(matrix, matrix.offsets[i], matrix.offsets[i + 1], x, entry(b, i));
}

}  // namespace

void multiply(const BlockMatrix& matrix, const TangentVector& x, TangentVector& y, int threads) {
  y.resize(2 * static_cast<Eigen::Index>(matrix.size()));
  forEachBlock(matrix.size(), threadCount(threads, matrix.size()),
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
  levels_[0].matrix = &matrix;
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    Level& level = levels_[l];
    const HierarchyLevel& next = hierarchy_.levels[first_ + l];
    const std::vector<TangentBasis>& fine = l == 0 ? bases : levels_[l - 1].coarse_bases;
    level.coarse_bases.resize(next.seeds.size());
    for (std::size_t s = 0; s < next.seeds.size(); ++s)
      level.coarse_bases[s] = fine[static_cast<std::size_t>(next.seeds[s])];
    if (!has_patterns_)
      findPatterns(l);
    // Prolongation of tangent vectors: those of the seeds, turned into the tangent plane of the
    // node.
    const double* const weights = next.prolongation.valuePtr();
    const std::size_t n = level.matrix->size();
    level.inverse_diagonal.resize(n);
    forEachBlock(n, threadCount(threads_, n), [&](std::size_t, std::size_t begin, std::size_t end) {
      BlockMatrix& prolongation = level.prolongation;
      for (std::size_t i = begin; i < end; ++i) {
        for (std::size_t e = prolongation.offsets[i]; e < prolongation.offsets[i + 1]; ++e) {
          const auto c = static_cast<std::size_t>(prolongation.columns[e]);
          prolongation.blocks[e] = weights[e] * (fine[i].transpose() * level.coarse_bases[c]);
        }
        level.inverse_diagonal[i] = regularizedInverse(level.matrix->blocks[level.diagonal[i]]);
      }
    });
    multiplyGalerkin(l);
  }
  has_patterns_ = true;
  coarsest_.compute(*levels_.back().matrix);
}

void MultigridPreconditioner::Level::findRestrictionPattern() {
  restriction_offsets.assign(coarse_bases.size() + 1, 0);
  for (const Index column : prolongation.columns)
    ++restriction_offsets[static_cast<std::size_t>(column) + 1];
  std::partial_sum(restriction_offsets.begin(), restriction_offsets.end(),
                   restriction_offsets.begin());
  restriction_rows.resize(prolongation.columns.size());
  restriction_places.resize(prolongation.columns.size());
  std::vector<std::size_t> ends(restriction_offsets.begin(), restriction_offsets.end() - 1);
  for (std::size_t i = 0; i < prolongation.size(); ++i)
    for (std::size_t e = prolongation.offsets[i]; e < prolongation.offsets[i + 1]; ++e) {
      const std::size_t place = ends[static_cast<std::size_t>(prolongation.columns[e])]++;
      restriction_rows[place] = static_cast<Index>(i);
      restriction_places[place] = e;
    }
}

void MultigridPreconditioner::Level::findGalerkinPattern(BlockMatrix& next) {
  const std::size_t coarse = coarse_bases.size();
  std::vector<Index> stamp(coarse, -1);
  product.offsets.assign(1, 0);
  product.columns.clear();
  for (std::size_t i = 0; i < matrix->size(); ++i) {
    for (std::size_t e = matrix->offsets[i]; e < matrix->offsets[i + 1]; ++e)
      addColumns(static_cast<Index>(i), prolongation, matrix->columns[e], stamp, product.columns);
    product.offsets.push_back(product.columns.size());
  }
  std::fill(stamp.begin(), stamp.end(), -1);
  next.offsets.assign(1, 0);
  next.columns.clear();
  for (std::size_t c = 0; c < coarse; ++c) {
    for (std::size_t r = restriction_offsets[c]; r < restriction_offsets[c + 1]; ++r)
      addColumns(static_cast<Index>(c), product, restriction_rows[r], stamp, next.columns);
    std::sort(next.columns.begin() + static_cast<std::ptrdiff_t>(next.offsets.back()),
              next.columns.end());
    next.offsets.push_back(next.columns.size());
  }
  next.blocks.resize(next.columns.size());
}

void MultigridPreconditioner::findPatterns(std::size_t l) {
  Level& level = levels_[l];
  Level& next = levels_[l + 1];
  const auto& weights = hierarchy_.levels[first_ + l].prolongation;
  const BlockMatrix& matrix = *level.matrix;
  const std::size_t n = matrix.size();
  const auto entries = static_cast<std::size_t>(weights.nonZeros());
  findDiagonal(matrix, level.diagonal);

  BlockMatrix& prolongation = level.prolongation;
  prolongation.offsets.assign(weights.outerIndexPtr(), weights.outerIndexPtr() + n + 1);
  prolongation.columns.assign(weights.innerIndexPtr(), weights.innerIndexPtr() + entries);
  prolongation.blocks.resize(entries);

  level.findRestrictionPattern();
  level.findGalerkinPattern(next.galerkin);
  next.matrix = &next.galerkin;
}

void MultigridPreconditioner::multiplyGalerkin(std::size_t l) {
  Level& level = levels_[l];
  const BlockMatrix& matrix = *level.matrix;
  const BlockMatrix& prolongation = level.prolongation;
  const BlockMatrix& product = level.product;
  BlockMatrix& galerkin = levels_[l + 1].galerkin;
  const std::size_t n = matrix.size();
  const int threads = threadCount(threads_, n);
  if (product_.size() < product.columns.size())
    product_.resize(product.columns.size());
  places_.resize(std::max(places_.size(), static_cast<std::size_t>(threads)));
  for (std::vector<Index>& places : places_)
    if (places.size() < galerkin.size())
      places.resize(galerkin.size());
  /// Empties a row of a result and finds the places of its columns.
  const auto begin_row = [](const BlockMatrix& pattern, std::size_t row, Eigen::Matrix2d* blocks,
                            std::vector<Index>& places) {
    for (std::size_t e = pattern.offsets[row]; e < pattern.offsets[row + 1]; ++e) {
      const std::size_t place = e - pattern.offsets[row];
      blocks[place].setZero();
      places[static_cast<std::size_t>(pattern.columns[e])] = static_cast<Index>(place);
    }
  };
  forEachItem(n, threads, [&](std::size_t thread, std::size_t i) {
    std::vector<Index>& places = places_[thread];
    Eigen::Matrix2d* const row = product_.data() + product.offsets[i];
    begin_row(product, i, row, places);
    for (std::size_t e = matrix.offsets[i]; e < matrix.offsets[i + 1]; ++e) {
      const auto j = static_cast<std::size_t>(matrix.columns[e]);
      const Eigen::Matrix2d left = matrix.blocks[e];
      for (std::size_t p = prolongation.offsets[j]; p < prolongation.offsets[j + 1]; ++p)
        row[places[static_cast<std::size_t>(prolongation.columns[p])]] +=
            left.lazyProduct(prolongation.blocks[p]);
    }
  });
  forEachItem(galerkin.size(), threads, [&](std::size_t thread, std::size_t c) {
    std::vector<Index>& places = places_[thread];
    Eigen::Matrix2d* const row = galerkin.blocks.data() + galerkin.offsets[c];
    begin_row(galerkin, c, row, places);
    for (std::size_t r = level.restriction_offsets[c]; r < level.restriction_offsets[c + 1]; ++r) {
      const auto i = static_cast<std::size_t>(level.restriction_rows[r]);
      const Eigen::Matrix2d left = prolongation.blocks[level.restriction_places[r]].transpose();
      for (std::size_t e = product.offsets[i]; e < product.offsets[i + 1]; ++e)
        row[places[static_cast<std::size_t>(product.columns[e])]] += left.lazyProduct(product_[e]);
    }
  });
}

void MultigridPreconditioner::apply(const TangentVector& b, TangentVector& x) {
  cycle(0, b, x);
}

void MultigridPreconditioner::cycle(std::size_t l, const TangentVector& b, TangentVector& x) {
  Level& level = levels_[l];
  if (l + 1 == levels_.size()) {
    coarsest_.solve(b, x);
    return;
  }
  Level& next = levels_[l + 1];
  const std::size_t n = level.matrix->size();
  const int threads = threadCount(threads_, n);
  smoothFromZero(*level.matrix, level.diagonal, level.inverse_diagonal, b, x, level.residual,
                 threads);
  const std::size_t coarse = next.matrix->size();
  next.right_side.resize(2 * static_cast<Eigen::Index>(coarse));
  forEachBlock(coarse, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (std::size_t r = level.restriction_offsets[c]; r < level.restriction_offsets[c + 1]; ++r)
        sum += level.prolongation.blocks[level.restriction_places[r]].transpose() *
               entry(level.residual, static_cast<std::size_t>(level.restriction_rows[r]));
      next.right_side.segment<2>(2 * static_cast<Eigen::Index>(c)) = sum;
    }
  });
  cycle(l + 1, next.right_side, next.solution);
  forEachBlock(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    const BlockMatrix& prolongation = level.prolongation;
    for (std::size_t i = begin; i < end; ++i) {
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (std::size_t e = prolongation.offsets[i]; e < prolongation.offsets[i + 1]; ++e)
        sum += prolongation.blocks[e] *
               entry(next.solution, static_cast<std::size_t>(prolongation.columns[e]));
      x.segment<2>(2 * static_cast<Eigen::Index>(i)) += sum;
    }
  });
  smoothBackward(*level.matrix, level.inverse_diagonal, b, x);
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
  while (solution.iterations < tolerance.max_iterations && square > goal) {
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
