#pragma once

#include "graph.h"
#include "rotation_system.h"
#include "sphere_mesh.h"
#include "spherical_param/types.h"

#include <optional>

namespace spherical_param::internal {

/// Finds a closed mesh of the faces of a rotation system; triangles that fill loops are open. A few
/// false edges of a graph fold the whole embedding, but faces elsewhere are still right.
///
/// 1. Triangles, and faces of up to 12 nodes, which are cut into triangles, form a mesh with
///    openings. Where several fans meet in a node, the largest stays.
/// 2. The boundary loops are filled with triangles, the shortest edges first, and the pieces joined
///    by tubes along edges of the graph.
///
/// \param points   3 x n.
/// \param graph    n nodes, connected.
/// \param rotation of its edges.
/// \return nothing if the faces do not enclose at least 4 nodes. Cost: O(n log n).
std::optional<SphereMesh> meshFaces(const Positions& points, const Graph& graph,
                                    const RotationSystem& rotation);

/// Cuts the handles of a mesh of faces: a planar region grows over it. The triangles that it cannot
/// take are left out, and the loops are filled again.
///
/// \return nothing if handles remain.
std::optional<SphereMesh> withoutHandles(const Positions& points, const Graph& graph,
                                         SphereMesh mesh);

/// The mesh of faces with all nodes and without open triangles: puts each missing node into a
/// triangle near a neighbour.
SphereMesh withAllNodes(const Positions& points, const Graph& graph, const SphereMesh& faces);

}  // namespace spherical_param::internal
