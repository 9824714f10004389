#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup parts
/// @{

/// Points that form a surface of their own.
struct Part {
  std::vector<Index> points;  ///< their numbers, ascending
  Eigen::Vector3d box_min;    ///< lowest coordinates of these points [unit of the input]
  Eigen::Vector3d box_max;    ///< highest ones
};

/// A cloud, taken apart.
struct Parts {
  std::vector<Part> parts;      ///< that of most points first; of two, that of the lowest point
  std::vector<Index> left_out;  ///< points of no part, ascending
};

/// Takes a cloud apart into its surfaces, each for a call of reconstruct().
///
/// They are the connected components of the graph of local Delaunay neighbourhoods before anything
/// is repaired or joined: points are neighbours if each is in the star of the other. A component of
/// too few distinct points is none; each point of it belongs to the part beside it if that has it
/// in a star, or is no farther than the mean distance of neighbours there and 6 times the
/// roughness, and to no part otherwise.
///
/// \param points 3 x n, finite. Points at one position are in one part.
/// \param min_points distinct points of a part at least; 4 and up.
/// \param execution threads, progress; the stages are "neighbors" and "graph".
/// \return the parts, the same for any number of threads; none if all are too small.
/// \throw InvalidInput for coordinates that are not finite, or arguments out of range; Cancelled.
/// Cost: that of a neighbour graph.
///
/// No guarantees: surfaces that touch are one part, and sparse stray points may form a part: see
/// findStrayPoints().
Parts findParts(const Positions& points, int min_points = 50, const Execution& execution = {});

/// @}

}  // namespace spherical_param
