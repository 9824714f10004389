#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The place of an index in an array.
inline std::size_t slotOf(Index i) {
  return static_cast<std::size_t>(i);
}

/// Neighbour lists of all nodes, and a search for longer lists.
struct Neighbors {
  NeighborLists lists;
  NeighborSearch search;  ///< may be empty
};

/// Some of the nodes of a cloud, numbered anew.
struct NodeSubset {
  std::vector<Index> old_of_new;  ///< m entries: the node among all
  std::vector<Index> new_of_old;  ///< n entries: the node of the subset; -1: removed
  /// m entries: whether a removed node is in the list of this node. Filled by neighborsOf().
  std::vector<char> has_lost;
};

/// The `count` nearest neighbours of all of n nodes.
Neighbors findNeighbors(NeighborSearch search, std::size_t n, int count);

/// The neighbours of a subset: lists with removed nodes are searched again, others are kept.
///
/// \param points 3 x m, of the subset.
/// \param all    of all nodes; its search must outlive the result.
/// \param count  as in findNeighbors().
/// \param subset must outlive the result.
Neighbors neighborsOf(const Positions& points, const Neighbors& all, int count, NodeSubset& subset);

/// A search within a subset: it asks for enough neighbours among all nodes.
///
/// \param points, search, subset must outlive the result.
NeighborSearch searchWithin(const Positions& points, const NeighborSearch& search,
                            const NodeSubset& subset);

/// Checks the answer of a caller's search: `count` lists of indices in [0, n).
/// \throw InvalidInput
void checkLists(const NeighborLists& lists, std::size_t count, std::size_t n);

}  // namespace spherical_param::internal
