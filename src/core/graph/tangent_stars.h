#pragma once

#include "indexed.h"
#include "neighbor_search.h"
#include "rows.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// How the star of a point was found.
struct StarKind {
  Index candidates = -1;       ///< number of known nearest points; -1: not processed
  bool tangent_plane = false;  ///< the tangent plane is reliable
  bool wants_more = false;     ///< more candidates may help: the star is not certified
};

/// The star of each node: its Voronoi neighbours in its tangent plane, or its neighbours in the
/// Gabriel graph if the nearest points span no plane. The star of node i is nodes[begin[i]] ...
/// nodes[begin[i] + count[i] - 1], ascending.
struct Stars {
  explicit Stars(std::size_t n = 0) : begin(n), count(n), kind(n) {}

  Indexed<std::size_t> begin;
  Indexed<Index> count;
  std::vector<Index> nodes;
  Indexed<StarKind> kind;

  std::size_t size() const { return begin.size(); }
  /// Positions of a star in `nodes`.
  NumberRange<std::size_t> entries(Index i) const {
    return {begin[i], begin[i] + static_cast<std::size_t>(count[i])};
  }
  Row<Index> of(Index i) const {
    return {nodes.data() + begin[i], nodes.data() + begin[i] + count[i]};
  }
};

/// Finds the stars of all nodes. A star is certified if no point beyond the list can change it: the
/// list reaches twice the radius of the Voronoi cell. For uncertified stars more neighbours are
/// searched, once a round for all of them. If the nearest neighbours span no plane (a line, all
/// directions alike, too few points), the star is that of the Gabriel graph of the list (Gabriel
/// and Sokal 1969).
///
/// \param points    3 x n, finite, distinct.
/// \param neighbors of the nodes.
/// \param execution threads, progress
/// \return the stars; the same, bit by bit, for any number of threads.
/// Cost: O(n c log c) for lists of c points.
Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution);

}  // namespace spherical_param::internal
