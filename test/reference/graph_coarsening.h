#pragma once

#include "graph_hierarchy.h"
#include "graph.h"
#include "spherical_param/types.h"

#include <cstdint>

namespace spherical_param::reference {

/// What buildGraphHierarchy() is to make of a graph as its first level: nodes are sorted for the
/// independent set, the cells found by Dijkstra's algorithm from all seeds, and all else kept in
/// maps.
///
/// \param graph connected, with positive edge lengths.
internal::HierarchyLevel coarsen(const Graph& graph, std::uint32_t seed);

}  // namespace spherical_param::reference
