#pragma once

#include "neighbors.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// How the star of a point was found.
struct StarKind {
  Index candidates = -1;        ///< nearest points that are known; -1: not looked at yet
  bool tangent_plane = false;   ///< there is one that can be trusted
  bool certified = false;       ///< no further point can change the star
  bool wants_more = false;      ///< more candidates may help
  bool is_beyond_list = false;  ///< more neighbours than those of its list were searched for
};

/// The star of each node: its Voronoi neighbours in its tangent plane, or, where the nearest points
/// span no plane, its neighbours in the Gabriel graph. Those of node i are nodes[begin[i]] ...
/// nodes[begin[i] + count[i] - 1], ascending.
struct Stars {
  explicit Stars(std::size_t n = 0) : begin(n), count(n), kind(n), nearest(n) {}

  std::vector<std::size_t> begin;
  std::vector<Index> count;
  std::vector<Index> nodes;
  std::vector<StarKind> kind;
  std::vector<std::array<Index, 3>> nearest;  ///< the three nearest; -1: unknown
  Index searched_again = 0;                   ///< nodes for which more neighbours were searched

  std::size_t size() const { return begin.size(); }
  std::size_t endOf(std::size_t i) const { return begin[i] + static_cast<std::size_t>(count[i]); }
  /// Whether j is in the star of i.
  bool holds(Index i, Index j) const;
  /// For each node whether it is in the star of one of the given ones (n entries each).
  std::vector<char> inStarsOf(const std::vector<char>& given) const;
};

/// Finds the stars of all nodes. A star is certified if no point outside of the list can change it:
/// twice the radius of the Voronoi cell is within the list. More neighbours are searched for where
/// it is not, once a round for all such points together. Where the nearest neighbours span no plane
/// (a line, all directions alike, too few points), the star is that of the Gabriel graph of the
/// list (Gabriel and Sokal 1969).
///
/// \param points    3 x n, finite, distinct.
/// \param neighbors of the nodes.
/// \param execution threads, progress
/// \return the stars; the same, bit by bit, for any number of threads.
/// Cost: O(n c log c) for lists of c points.
Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution);

/// The stars of some nodes when the others are taken out: those that none of these can have changed
/// are kept, the others found anew.
///
/// \param points    3 x m, the nodes that stay.
/// \param neighbors of these.
/// \param all       the stars before.
/// \param subset    which these are.
/// \param execution threads, progress
Stars findStars(const Positions& points, const Neighbors& neighbors, const Stars& all,
                const NodeSubset& subset, const Execution& execution);

}  // namespace spherical_param::internal
