#pragma once

#include "spherical_param/errors.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace spherical_param::internal {

/// Refuses a graph whose arrays do not fit, that names a node that it has not, or whose lengths are
/// none: paths over negative ones get shorter for ever. 0 is what very short ones are rounded to. A
/// graph in parts makes results that are of no use, but nothing worse.
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
  if (!std::all_of(graph.lengths.begin(), graph.lengths.end(),
                   [](double length) { return length >= 0.0 && std::isfinite(length); }))
    throw InvalidInput(function + ": an edge's length is negative or not finite; bring the points "
                                  "to an extent of about 1");
}

}  // namespace spherical_param::internal
