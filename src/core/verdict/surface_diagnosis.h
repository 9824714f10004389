#pragma once

#include "graph.h"
#include "spherical_param/result.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Parameters of diagnoseSurface().
struct DiagnosisOptions {
  std::size_t max_vertices = 64;  ///< maximum number of vertices listed with each finding
  bool mark_triangles = false;    ///< fill SurfaceDiagnosis::triangle_marks
  /// Count the graph's cycles to distinguish handles from folds. On a folded mesh this takes longer
  /// than all the rest; without it, such a mesh is SurfaceKind::Unclear.
  bool count_cycles = true;
  int genus = 0;  ///< of the mesh, filled where it is open
};

/// Decides whether a cloud looks like a closed surface of the mesh's genus; the mesh alone does not
/// show it.
/// Openings come from the graph; cut handles separate neighbours on the mesh; without its bridges
/// the graph falls into parts.
///
/// \param points    3 x n, finite, of an extent about 1.
/// \param triangles 3 x m, a manifold over the points, closed or with openings.
/// \param graph     n nodes, lengths in the unit of the points. Thresholds were measured on tangent
///                  Delaunay graphs and hold for 8 nearest neighbours; of a graph with a mean
///                  degree above 12, the 8 shortest edges of each point are used.
/// \param bridges   edges of the graph that join parts (GraphReport::bridges).
/// \param openings  of the graph, with the triangles over filled ones.
/// \param options   lists, marks, cycles
/// \param threads 0: one for each processor; [0, 1024].
/// \return the diagnosis, the same for any number of threads.
/// Cost: O(n) for a sound surface.
///
/// Handles are sought in clouds of one part. If the mesh is not folded, torn neighbours show them,
/// and the cycles of the graph count them; without cycles there is no handle. If it is folded, as
/// over most large handles, only the cycles count, unless there are certain openings.
///
/// Not guaranteed: handles of less than some 9 points around pass for uneven sampling. With noise
/// as large as the spacing, cycles are not counted: SurfaceDiagnosis::genus is unset. A handle may
/// be cut in several places.
SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const std::vector<Opening>& openings,
                                 const DiagnosisOptions& options = {}, int threads = 0);

}  // namespace spherical_param::internal
