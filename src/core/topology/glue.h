#pragma once

#include "cut_graph.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// Glues spheres whose rims have virtual nodes inside: takes these out, and makes one vertex of the
/// two copies of each node of a rim.
///
/// A sphere that is turned inside out is turned back. Edges of rims that a sphere lacks are made by
/// flips in the strip of triangles between their ends; nodes on the wrong side of a rim are taken
/// out, and put back beside a neighbour; edges that two rims would double are flipped.
///
/// \param nodes   number of nodes before the cut.
/// \param cut     the nodes of the spheres, and the rims.
/// \param spheres 3 x m, closed, oriented manifolds of genus 0 over all vertices.
/// \param count   number of spheres.
/// \param vertices the nodes of the cut graph, and the virtual nodes in rims.
/// \return a closed, oriented manifold in one piece over all nodes, with a handle for each pair of
/// rims that is not needed to join the spheres. Nothing if that cannot be reached.
std::optional<Triangles> glue(std::size_t nodes, const CutGraph& cut, Triangles spheres,
                              std::size_t count, Index vertices);

}  // namespace spherical_param::internal
