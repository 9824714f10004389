#pragma once

#include "cgal_conversions.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::benchmark {

using TriangleSoup = std::vector<std::array<std::size_t, 3>>;

/// Says how advanceFront() does it.
extern const std::string cgal_advancing_front_parameters;

/// Triangles of indices of points, not all of which need to be used.
TriangleSoup advanceFront(const std::vector<Kernel::Point_3>& points);

}  // namespace spherical_param::benchmark
