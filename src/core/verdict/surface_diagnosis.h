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
  bool may_be_one_sided = false;  ///< the cloud may sample a surface with one side
};

/// Compares a mesh with the graph of its cloud: parts that it joins, edges that leave the graph.
///
/// \param points    3 x n, finite, of an extent about 1.
/// \param triangles 3 x m, a manifold over the points, closed or with openings.
/// \param graph     n nodes, lengths in the unit of the points. Thresholds were measured on tangent
///                  Delaunay graphs and hold for 8 nearest neighbours; of a graph with a mean
///                  degree above 12, the 8 shortest edges of each point are used.
/// \param bridges   edges of the graph that join parts (NeighborGraph::bridges).
/// \param options   lists, marks: triangle_mark::part_bridge and outside_graph.
/// \param threads 0: one for each processor; [0, 1024].
/// \return the diagnosis, the same for any number of threads. Cost: O(n).
SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const DiagnosisOptions& options = {}, int threads = 0);

}  // namespace spherical_param::internal
