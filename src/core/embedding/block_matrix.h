#pragma once

#include "spherical_param/types.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Tangent vectors of n nodes in their tangent bases: 2n entries, node i has 2i and 2i + 1.
using TangentVector = Eigen::VectorXd;

/// Square matrix of 2 x 2 blocks in compressed rows, on tangent vectors.
struct BlockMatrix {
  std::vector<std::size_t> offsets{0};  ///< n + 1
  std::vector<Index> columns;           ///< ascending in each row; includes the diagonal
  std::vector<Eigen::Matrix2d> blocks;

  std::size_t size() const { return offsets.size() - 1; }  ///< number of rows of blocks, n
};

}  // namespace spherical_param::internal
