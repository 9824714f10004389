#pragma once

#include "graph.h"
#include "indexed.h"
#include "rotation_system.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace spherical_param::internal {

/// A closed mesh of the faces of a graph.
struct FaceMesh {
  Triangles triangles;               ///< a closed, oriented manifold in one piece over most nodes
  Indexed<std::uint8_t> is_filling;  ///< for each triangle, 1 if it is in no face of the graph
  std::size_t genus = 0;             ///< number of handles
};

/// Finds a closed mesh of the faces of a rotation system. Where a few edges of a graph are false,
/// the embedding of all is folded, but all faces elsewhere are right.
///
/// 1. Triangles, and faces of up to 12 nodes, cut into triangles, are a mesh with openings. Where
///    several fans meet in a node, the largest stays.
/// 2. The boundary loops are filled with triangles, the shortest edges first, and the pieces joined
///    by tubes along edges of the graph.
///
/// \param points   3 x n.
/// \param graph    n nodes, connected.
/// \param rotation of its edges.
/// \return nothing if the faces do not enclose at least 4 nodes. Cost: O(n log n).
std::optional<FaceMesh> meshFaces(const Positions& points, const Graph& graph,
                                  const RotationSystem& rotation);

/// Opens the handles of a mesh of faces: a region of genus 0 grows over it; the triangles that it
/// cannot take are left out, and the loops filled again.
///
/// \return nothing if handles are left.
std::optional<FaceMesh> withoutHandles(const Positions& points, const Graph& graph, FaceMesh mesh);

/// Puts each node of a graph that a closed mesh does not have into a triangle near a neighbour.
Triangles withAllNodes(const Positions& points, const Graph& graph, const Triangles& closed);

}  // namespace spherical_param::internal
