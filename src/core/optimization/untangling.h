#pragma once

#include "workbench.h"

namespace spherical_param::internal {

/// Ruins and recreates parts around intersecting triangles, in rounds: some by energy, then by the
/// number of intersections, with larger parts once small ones no longer help.
///
/// \param pairs of triangles that intersect; a sample is left alone.
/// \param rounds_by_energy number of the first rounds.
/// \return the pairs that are left.
IntersectingPairs untangle(Workbench& bench, IntersectingPairs pairs, int rounds_by_energy);

}  // namespace spherical_param::internal
