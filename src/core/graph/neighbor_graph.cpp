#include "neighbor_graph.h"

#include "local_delaunay_graph.h"
#include "nearest_neighbor_graph.h"
#include "progress.h"

namespace spherical_param {
NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 GraphMethod method, int k, const NeighborSearch& search,
                                 const Execution& execution) {
  internal::reportFraction(internal::reportOf(execution, "graph"), 0.0);
  NeighborGraph result = method == GraphMethod::NearestNeighbors
                             ? internal::buildNearestNeighborGraph(points, lists, k)
                             : internal::buildLocalDelaunayGraph(points, lists, search, execution);
  result.report.edges = result.graph.edgeCount();
  return result;
}

}  // namespace spherical_param
