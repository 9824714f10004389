#pragma once

#include "spherical_param/mesh_topology.h"
#include "spherical_param/types.h"

namespace spherical_param::reference {

/// What checkTopology() is to find, from its definitions: a map of edges, sets that are merged
/// around each vertex, and a walk over what hangs together.
///
/// \param triangles 3 x m, indices in [0, n).
MeshTopology topologyOf(const Triangles& triangles, Index n);

}  // namespace spherical_param::reference
