#pragma once

#include "cut_graph.h"
#include "graph.h"
#include "handles.h"
#include "open_surface.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"

#include <optional>
#include <vector>

namespace spherical_param::internal {

/// A surface that is cut into spheres.
struct SurfaceCut {
  std::vector<CutLoop> handles;
  /// Along the handles and the necks, if there are any; along the handles alone, if that leaves one
  /// to be cut.
  std::vector<CutGraph> graphs;
  /// Whether one sphere can hold the surface.
  bool has_sphere = false;
};

/// What is known of a surface before it is meshed.
struct SurfaceTopology {
  OpenSurface openings;
  /// Along all handles that were found; along those that are certain, if not all are; along necks
  /// alone. Empty: the surface is a sphere.
  std::vector<SurfaceCut> cuts;
};

/// Finds the openings, the handles and the necks of a surface.
///
/// \param points   nodes, must outlive the result.
/// \param graph    of the nodes.
/// \param is_flat  all points are in one plane: openings cannot be filled.
/// \param unit     of the nodes' coordinates [unit of the input].
SurfaceTopology findTopology(const Positions& points, const Graph& graph, bool is_flat, double unit,
                             const Options& options, const Execution& execution);

}  // namespace spherical_param::internal
