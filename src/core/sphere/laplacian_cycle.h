#pragma once

#include "graph_hierarchy.h"

#include <Eigen/SparseCholesky>

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A symmetric multigrid V-cycle for the Laplacian of a graph, on the three coordinates of its
/// nodes: Galerkin operators on the levels of a hierarchy, one Gauss-Seidel sweep before (forward)
/// and after (backward) each correction, sparse Cholesky on the coarsest level. Without coarser
/// levels it is a direct solver.
class LaplacianCycle {
public:
  /// \param hierarchy must outlive this.
  /// \param first     index of the next coarser level than the matrix.
  LaplacianCycle(const GraphHierarchy& hierarchy, std::size_t first);

  /// \param laplacian n x n, symmetric, positive definite up to rounding; later ones must have the
  ///                  pattern of the first.
  void compute(const SparseRows& laplacian);

  /// An approximate solution x of laplacian x = b, each 3 x n.
  Positions apply(const Positions& b) const;

private:
  using Field = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  Field cycle(std::size_t l, const Field& b) const;

  const GraphHierarchy& hierarchy_;
  std::size_t first_;
  std::vector<SparseRows> matrices_;  ///< of each level
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> coarsest_;
  bool has_pattern_ = false;
};

}  // namespace spherical_param::internal
