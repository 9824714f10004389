#pragma once

#include "neighbor_search.h"
#include "ordered_points.h"
#include "spherical_param/types.h"

namespace spherical_param::internal {

/// Neighbour lists of all nodes, and a search for longer ones of some.
struct Neighbors {
  NeighborLists lists;
  NeighborSearch search;  ///< may be empty
};

/// The nearest neighbours of the nodes by a k-d tree.
Neighbors nearestNeighbors(const OrderedPoints& nodes, int count, const Execution& execution);

/// The neighbours that a caller has found, from numbers of input points to numbers of nodes. A node
/// gets the entries of all its input points.
///
/// \param lists  of the input points; checked here.
/// \param search among the input points; may be empty. It must outlive the result, as `nodes` must.
/// \throw InvalidInput
Neighbors callerNeighbors(const OrderedPoints& nodes, const NeighborLists& lists,
                          const NeighborSearch& search);

}  // namespace spherical_param::internal
