#pragma once

#include "neighbor_graph.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// Parameters of diagnoseSurface().
struct DiagnosisOptions {
  std::size_t max_vertices = 64;  ///< maximum number of vertices listed with each finding
  bool mark_triangles = false;    ///< fill SurfaceDiagnosis::triangle_marks
  /// Count the graph's cycles, which tell handles from folds. Where a mesh is folded, that takes
  /// longer than all the rest; without it, what may be either is SurfaceKind::Unclear.
  bool count_cycles = true;
};

/// Decides whether a cloud looks like a closed genus-0 surface: the mesh always is one, or one with
/// openings, whatever the cloud shows. Openings are known from the graph; a handle is cut, and
/// neighbours become distant; the graph itself falls into the parts that were joined by bridges.
///
/// \param points    3 x n, finite; extent about 1, or at least such that areas are numbers.
/// \param triangles 3 x m, a manifold over the points: closed, or with openings that are left open.
/// \param graph     n nodes, lengths in the unit of the points. The thresholds were measured on
///                  local Delaunay neighbourhoods and hold for the 8 nearest neighbours as well; of
///                  a graph with a mean degree above 12, the 8 shortest edges of each point are
///                  used.
/// \param bridges   edges of the graph that join parts (GraphReport::bridges).
/// \param openings  of the graph, with the triangles over those that are filled.
/// \param options what is listed
/// \param threads OpenMP threads; 0: as many as OpenMP would use; [0, 1024].
/// \return what was found, the same for any number of threads.
/// Cost: O(n) where nothing is wrong.
///
/// Handles are sought where there is one part only: by neighbours that the mesh tears apart, where
/// it is not folded, and then counted by the cycles of the graph, which do not depend on the mesh.
/// Torn neighbours in a graph without such cycles are no handle. Where the mesh is folded, as it is
/// over most handles of many points, the cycles alone are asked, unless there are openings.
///
/// Not guaranteed: handles of less than some 9 points around are taken for uneven sampling. Where
/// noise is as large as the spacing, cycles are not counted: SurfaceDiagnosis::genus is unset. One
/// handle may be cut in several places.
SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const std::vector<Opening>& openings,
                                 const DiagnosisOptions& options = {}, int threads = 0);

/// @}

}  // namespace spherical_param
