#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

/// Core of the library: meshing of genus-0 point clouds by spherical parameterisation.
/// Its headers need Eigen and the standard library only. It reads and writes no files and prints
/// nothing.
namespace spherical_param {

/// \addtogroup types
/// @{

/// Index of a point, vertex or triangle. 32 bits: a cloud has fewer than 2^30 points.
using Index = std::int32_t;

/// 3 x n, column i = point i, in the unit of the input (or unit vectors, where said so).
using Positions = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// 3 x m, column t = the three vertices of triangle t, counter-clockwise seen from outside.
using Triangles = Eigen::Matrix<Index, 3, Eigen::Dynamic>;

/// Neighbour lists of n points, stored one after the other.
/// List i is indices[offsets[i]] ... indices[offsets[i + 1] - 1], in any order. It may contain i
/// itself, repeated entries, and any number of entries.
struct NeighborLists {
  std::vector<std::size_t> offsets{0};  ///< n + 1 positions in `indices`, ascending, the first 0
  std::vector<Index> indices;           ///< neighbours, each in [0, n)

  /// Number of lists. \return n
  std::size_t size() const { return offsets.size() - 1; }
};

/// Undirected graph in compressed rows: every edge is stored at both of its ends.
/// Rows are sorted by ascending neighbour, without repetition and without self-loops.
struct Graph {
  std::vector<std::size_t> offsets{0};  ///< n + 1 positions in `neighbors` and `lengths`
  std::vector<Index> neighbors;         ///< 2 x edges entries
  /// Euclidean length of each entry's edge [unit of the input]: finite and > 0, or 0 where that is
  /// what it is rounded to. What needs a graph throws InvalidInput for others.
  std::vector<double> lengths;

  /// Number of nodes. \return n
  std::size_t size() const { return offsets.size() - 1; }
  /// Number of undirected edges. \return half the number of entries
  std::size_t edgeCount() const { return neighbors.size() / 2; }
};

/// @}

}  // namespace spherical_param
