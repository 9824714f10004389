#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Which of many points of a surface to keep so that those that are left are spread evenly: again
/// and again the one goes that has the most and nearest others around it (C. Yuksel: "Sample
/// elimination for generating Poisson disk sample sets", 2015).
///
/// Points whose normals are more than a right angle apart do not see each other: they lie on two
/// sheets of the surface.
///
/// \param points 3 x n, finite; \param normals 3 x n; \param count at most n.
/// \param area   of the surface, > 0.
/// \return count indices, of points that are near each other in space mostly near in the order. The
/// same for any number of threads. Cost: O(n log n).
std::vector<Index> eliminateSamples(const Positions& points, const Positions& normals,
                                    std::size_t count, double area, int threads);

}  // namespace spherical_param::internal
