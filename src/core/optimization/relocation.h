#pragma once

#include "workbench.h"

#include <vector>

namespace spherical_param::internal {

/// All vertices with a sharp edge, or more than two edges away from a near neighbour in the graph,
/// ascending.
std::vector<Index> roughVertices(const EnergyMesh& mesh, const FractionReport& report = {});

/// Puts rough vertices where they cost least, and then rough ones near those that moved, in some
/// rounds.
void relocate(Workbench& bench, std::vector<Index> rough);

}  // namespace spherical_param::internal
