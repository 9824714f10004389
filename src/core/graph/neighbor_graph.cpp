#include "spherical_param/neighbor_graph.h"

#include "local_delaunay_graph.h"
#include "nearest_neighbor_graph.h"
#include "neighbor_lists.h"
#include "option_checks.h"
#include "parallel.h"
#include "progress.h"

namespace spherical_param {
namespace {

/// k of the paper, and the neighbours that certify most local Delaunay cells.
constexpr int kTypicalNearestNeighbors = 25;
constexpr int kTypicalDelaunayNeighbors = 12;

}  // namespace

int neighborsToSearch(const GraphOptions& options) {
  return options.k.value_or(options.method == GraphMethod::NearestNeighbors
                                ? kTypicalNearestNeighbors
                                : kTypicalDelaunayNeighbors);
}

NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 const GraphOptions& options, const NeighborSearch& search,
                                 const Execution& execution) {
  internal::checkOptions(options);
  internal::checkThreads(execution.threads);
  internal::checkNeighborLists("buildNeighborGraph", lists,
                               static_cast<std::size_t>(points.cols()));
  internal::reportFraction(internal::reportOf(execution, "graph"), 0.0);
  NeighborGraph result =
      options.method == GraphMethod::NearestNeighbors
          ? internal::buildNearestNeighborGraph(points, lists, neighborsToSearch(options))
          : internal::buildLocalDelaunayGraph(points, lists, options.agreement, search, execution);
  result.report.edges = result.graph.edgeCount();
  return result;
}

}  // namespace spherical_param
