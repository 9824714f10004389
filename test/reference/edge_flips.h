#pragma once

#include "graph.h"
#include "spherical_param/types.h"

namespace spherical_param::reference {

/// What internal::MeshOptimizer::flipAll() is to make of a mesh, with the energy that it begins
/// with: all gains in a sorted set, computed from the points alone whenever something near them
/// changes; the edge that gains most is flipped until none gains.
///
/// \param points    3 x n.
/// \param triangles 3 x (2n - 4), closed, manifold, oriented, of genus 0.
/// \param graph     n nodes: the mean length of its edges is the unit of gains.
Triangles flipAll(const Positions& points, const Triangles& triangles, const Graph& graph);

}  // namespace spherical_param::reference
