#pragma once

#include "energy_mesh.h"
#include "progress.h"
#include "spherical_param/types.h"

#include <array>
#include <vector>

namespace spherical_param::internal {

/// All pairs of triangles that intersect, by their slots in the mesh, none of which is free. Open
/// triangles do not count.
std::vector<std::array<Index, 2>> findIntersections(const EnergyMesh& mesh,
                                                    const FractionReport& report = {});

}  // namespace spherical_param::internal
