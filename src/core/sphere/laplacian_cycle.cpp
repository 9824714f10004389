#include "laplacian_cycle.h"

namespace spherical_param::internal {

LaplacianCycle::LaplacianCycle(const GraphHierarchy& hierarchy, std::size_t first)
    : hierarchy_(hierarchy), first_(first), matrices_(hierarchy.levels.size() - first + 1) {
  // A part that is tiny on the sphere makes the matrix nearly singular.
  coarsest_.setShift(0.0, 1.0 + 1e-11);
}

void LaplacianCycle::compute(const SparseRows& laplacian) {
  matrices_[0] = laplacian;
  for (std::size_t l = 0; l + 1 < matrices_.size(); ++l) {
    const SparseRows& prolongation = hierarchy_.levels[first_ + l].prolongation;
    const SparseRows product = matrices_[l] * prolongation;
    matrices_[l + 1] = SparseRows(prolongation.transpose()) * product;
  }
  const Eigen::SparseMatrix<double> last = matrices_.back();
  if (!has_pattern_)
    coarsest_.analyzePattern(last);
  has_pattern_ = true;
  coarsest_.factorize(last);
}

Positions LaplacianCycle::apply(const Positions& b) const {
  return cycle(0, b.transpose()).transpose();
}

LaplacianCycle::Field LaplacianCycle::cycle(std::size_t l, const Field& b) const {
  if (l + 1 == matrices_.size())
    return coarsest_.solve(b);
  const SparseRows& matrix = matrices_[l];
  const SparseRows& prolongation = hierarchy_.levels[first_ + l].prolongation;
  Field x = Field::Zero(b.rows(), 3);
  const auto solve_row = [&](Eigen::Index i) {
    Eigen::RowVector3d rest = b.row(i);
    double diagonal = 0.0;
    for (SparseRows::InnerIterator entry(matrix, i); entry; ++entry) {
      if (entry.col() == i)
        diagonal = entry.value();
      else
        rest -= entry.value() * x.row(entry.col());
    }
    x.row(i) = rest / diagonal;
  };
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    solve_row(i);
  const Field rest = b - matrix * x;
  x += prolongation * cycle(l + 1, prolongation.transpose() * rest);
  for (Eigen::Index i = b.rows(); i-- > 0;)
    solve_row(i);
  return x;
}

}  // namespace spherical_param::internal
