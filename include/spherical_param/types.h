#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
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

/// Returns the `count` nearest neighbours of each of `points`, one list for each in their order.
/// The point itself may be in its list; `count` should not include it. Lists may be shorter where
/// there are no more.
using NeighborSearch = std::function<NeighborLists(const std::vector<Index>& points, int count)>;

/// Makes a search among some points of a cloud, given by their numbers, ascending.
using NeighborSearchFactory = std::function<NeighborSearch(const std::vector<Index>& points)>;

/// @}

}  // namespace spherical_param
