#pragma once

#include "sampling_analysis.h"
#include "workbench.h"

#include <array>
#include <vector>

/// The phases of an optimisation. \see optimizeMesh()
namespace spherical_param::internal {

/// Flips with the energy that suits a sampling.
///
/// \param mu of a sampling that is not even.
void flipFor(Workbench& bench, const Sampling& sampling, double mu);

/// All vertices with a sharp edge, or more than two edges away from a near neighbour in the graph,
/// ascending.
std::vector<Index> roughVertices(const EnergyMesh& mesh, const FractionReport& report = {});

/// Puts rough vertices where they cost least, and then rough ones near those that moved, in some
/// rounds.
void relocate(Workbench& bench, std::vector<Index> rough);

/// Ruins and recreates parts around folded edges. Returns whether some are left.
bool unfold(Workbench& bench);

/// Ruins and recreates parts around intersecting triangles, in rounds: some by energy, then by the
/// number of intersections, with larger parts once small ones no longer help.
///
/// \param pairs of triangles that intersect.
/// \param rounds_by_energy number of the first rounds.
/// \return the pairs that are left.
std::vector<std::array<Index, 2>>
untangle(Workbench& bench, std::vector<std::array<Index, 2>> pairs, int rounds_by_energy);

/// Last flips and relocations, with the energy that suits the sampling.
void polish(Workbench& bench, const Sampling& sampling);

}  // namespace spherical_param::internal
