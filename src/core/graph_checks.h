#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace spherical_param::internal {

/// Refuses a graph whose arrays do not fit, or that names a node that it has not. A graph in parts,
/// or lengths that are none, make results that are of no use, but nothing worse.
///
/// \param function the public function that was given it, for the message.
inline void checkGraph(const std::string& function, const Graph& graph) {
  if (graph.offsets.empty() || graph.offsets.front() != 0 ||
      graph.neighbors.size() != graph.offsets.back() ||
      graph.lengths.size() != graph.neighbors.size() ||
      !std::is_sorted(graph.offsets.begin(), graph.offsets.end()))
    throw InvalidInput(function + ": the graph's arrays do not fit each other; use a graph from "
                                  "buildNeighborGraph()");
  for (const Index j : graph.neighbors)
    if (j < 0 || static_cast<std::size_t>(j) >= graph.size())
      throw InvalidInput(function + ": the graph names node " + std::to_string(j) + " of " +
                         std::to_string(graph.size()) + "; indices must be in [0, n)");
}

}  // namespace spherical_param::internal
