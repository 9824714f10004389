#pragma once

#include "progress.h"
#include "spherical_param/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// findSelfIntersections() for a mesh of which something is known: most of the pairs that it has to
/// look at are of neighbours.
///
/// \param fans for each point, 1 if no two triangles around it intersect, 0 if that is not known;
/// empty: nothing is known.
/// \param threads as there.
/// \param report called with the fraction that is done.
std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const std::vector<std::uint8_t>& fans,
                                                        int threads,
                                                        const FractionReport& report = {});

}  // namespace spherical_param::internal
