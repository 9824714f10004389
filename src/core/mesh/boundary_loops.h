#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The boundary loops of a manifold, with the surface on the left; the longest first, each from its
/// lowest vertex.
///
/// \param triangles    3 x m, a consistently oriented manifold with boundary.
/// \param vertex_count vertices are [0, vertex_count).
/// \return the same for any number of threads.
std::vector<std::vector<Index>> boundaryLoops(const Triangles& triangles, std::size_t vertex_count,
                                              int threads = 1);

}  // namespace spherical_param::internal
