#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

/// Core of the library: meshing of point clouds by spherical parameterisation.
/// Its headers need only Eigen and the standard library. It does no file I/O and prints nothing.
namespace spherical_param {

/// \addtogroup types
/// @{

/// Index of a point, vertex or triangle. 32 bits: a cloud has fewer than 2^30 points.
using Index = std::int32_t;

/// 3 x n, column i = point i, in the unit of the input, or unit vectors where stated.
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
/// A list may contain the point itself, which does not count. Lists are shorter if there are too
/// few points.
using NeighborSearch = std::function<NeighborLists(const std::vector<Index>& points, int count)>;

/// Makes a search among some points of a cloud, given by their indices, ascending.
using NeighborSearchFactory = std::function<NeighborSearch(const std::vector<Index>& points)>;

/// @}

}  // namespace spherical_param
