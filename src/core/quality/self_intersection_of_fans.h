#pragma once

#include "progress.h"
#include "spherical_param/types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// findSelfIntersections() that skips known fans: most candidate pairs are neighbours.
///
/// \param fans for each point, 1 if no two triangles around it intersect, 0 if unknown; empty: all
///             unknown.
/// \param report receives the fraction done.
std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const std::vector<std::uint8_t>& fans,
                                                        int threads,
                                                        const FractionReport& report = {});

}  // namespace spherical_param::internal
