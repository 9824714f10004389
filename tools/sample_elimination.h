#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::tools {

/// Chooses points of a surface that are spread evenly: takes out the point with the most and
/// nearest others around it, again and again (C. Yuksel: "Sample elimination for generating Poisson
/// disk sample sets", 2015).
///
/// \param points 3 x n, finite; \param count at most n.
/// \param area   of the surface, > 0.
/// \return count indices; neighbours in space are mostly near each other in the list. The same for
/// any number of threads. Cost: O(n log n).
std::vector<Index> eliminateSamples(const Positions& points, std::size_t count, double area);

}  // namespace spherical_param::tools
