#pragma once

#include "graph.h"
#include "handles.h"
#include "openings.h"
#include "rotation_system.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param::internal {

/// The necks of a surface.
struct Necks {
  std::vector<CutLoop> loops;
  /// Of the sphere that is squeezed most, without these [logarithm of a scale].
  double squeeze = 0.0;
};

/// Finds the necks of a surface: loops around tubes that are so long that a sphere would squeeze
/// them to nothing. Cut along its handles and necks, the surface is several spheres.
///
/// While a sphere is squeezed too much (\see worstWay), it is cut about half way to its narrowest
/// place: the loop is the shortest around a band, of at least 6 nodes, that divides the sphere.
///
/// \param points   3 x n.
/// \param graph    n nodes, the one that is cut.
/// \param openings that virtual nodes fill.
/// \param handles  loops along which the surface is cut into a sphere.
/// \return loops at least two steps from each other, the handles and the openings.
Necks findNecks(const Positions& points, const Graph& graph, const RotationSystem& rotation,
                const Openings& openings, const std::vector<CutLoop>& handles);

}  // namespace spherical_param::internal
