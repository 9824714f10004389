#pragma once

#include "block_cholesky.h"
#include "block_matrix.h"
#include "embedding_energy.h"
#include "graph_hierarchy.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// y = A x
void multiply(const BlockMatrix& matrix, const TangentVector& x, TangentVector& y, int threads);

/// A symmetric multigrid V-cycle for the positive semi-definite part of the Hessian: Galerkin
/// operators on the levels of a hierarchy, one block Gauss-Seidel sweep before (forward) and after
/// (backward) each correction, sparse Cholesky on the coarsest level. Without coarser levels it is
/// a direct solver. Its matrix need not be exact.
class MultigridPreconditioner {
public:
  /// \param hierarchy must outlive this. \param first index of the next coarser level than the
  /// matrix.
  MultigridPreconditioner(const GraphHierarchy& hierarchy, std::size_t first, int threads);

  int threads() const { return threads_; }

  /// Patterns are found for the first matrix; later ones must have the same pattern.
  ///
  /// \param matrix must outlive the next calls of apply().
  /// \param bases  tangent bases of the nodes of the finest level.
  void compute(const BlockMatrix& matrix, const std::vector<TangentBasis>& bases);

  /// An approximate solution x of matrix x = b.
  void apply(const TangentVector& b, TangentVector& x);

private:
  struct Level {
    const BlockMatrix* matrix = nullptr;
    BlockMatrix galerkin;               ///< storage of *matrix below the finest level
    std::vector<std::size_t> diagonal;  ///< places of the diagonal blocks
    std::vector<Eigen::Matrix2d> inverse_diagonal;
    BlockMatrix prolongation;  ///< nodes of this level x nodes of the next
    BlockMatrix product;       ///< pattern of *matrix * prolongation, without blocks; rows unsorted
    /// The transpose of the prolongation: for each node of the next level the rows and the places
    /// of its blocks.
    std::vector<std::size_t> restriction_offsets;
    std::vector<Index> restriction_rows;
    std::vector<std::size_t> restriction_places;
    std::vector<TangentBasis> coarse_bases;  ///< of the next level
    TangentVector right_side;
    TangentVector solution;
    TangentVector residual;

    /// The transpose of the prolongation's pattern.
    void findRestrictionPattern();
    /// The patterns of matrix times prolongation, and of restriction times that.
    ///
    /// \param next the matrix of the next level.
    void findGalerkinPattern(BlockMatrix& next);
  };

  void findPatterns(std::size_t l);
  void multiplyGalerkin(std::size_t l);
  void cycle(std::size_t l, const TangentVector& b, TangentVector& x);

  const GraphHierarchy& hierarchy_;
  std::size_t first_;
  int threads_;
  std::vector<Level> levels_;  ///< all but the coarsest have smoothers
  BlockCholesky coarsest_;
  std::vector<Eigen::Matrix2d> product_;    ///< blocks of the product of the level at hand
  std::vector<std::vector<Index>> places_;  ///< for each thread, of columns in the row at hand
  bool has_patterns_ = false;
};

/// Stopping rules of conjugateGradients().
struct LinearTolerance {
  double reduction = 0.1;  ///< of the residual, in the norm of the preconditioner
  int refinements = 0;     ///< V-cycles afterwards, each on the remaining residual
  int max_iterations = 200;
};

/// Outcome of conjugateGradients().
struct LinearSolution {
  TangentVector x;
  int iterations = 0;
};

/// Solves (H - diag(curvature) + barrier) x = -gradient by preconditioned conjugate gradients. Ends
/// early at a direction of negative curvature (T. Steihaug, 1983). The result is always a descent
/// direction.
LinearSolution conjugateGradients(const EmbeddingEnergy::Hessian& hessian,
                                  const std::vector<TangentBasis>& bases,
                                  MultigridPreconditioner& preconditioner,
                                  const TangentVector& gradient, const LinearTolerance& tolerance);

}  // namespace spherical_param::internal
