#pragma once

#include "workbench.h"

#include <array>
#include <vector>

namespace spherical_param::internal {

/// Ruins and recreates parts around intersecting triangles, in rounds: some by energy, then by the
/// number of intersections, with larger parts once small ones no longer help.
///
/// \param pairs of triangles that intersect.
/// \param rounds_by_energy number of the first rounds.
/// \return the pairs that are left.
std::vector<std::array<Index, 2>>
untangle(Workbench& bench, std::vector<std::array<Index, 2>> pairs, int rounds_by_energy);

}  // namespace spherical_param::internal
