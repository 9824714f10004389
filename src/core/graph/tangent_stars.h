#pragma once

#include "neighbor_search.h"
#include "progress.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// The star of a point, and how it was found.
struct Star {
  std::size_t begin = 0;       ///< its first node in Stars::nodes
  Index count = 0;             ///< of its nodes, ascending
  Index candidates = -1;       ///< number of known nearest points; -1: not processed
  bool tangent_plane = false;  ///< the tangent plane is reliable
  bool wants_more = false;     ///< more candidates may help: the star is not certified
  /// Height of the point over its tangent plane [standard deviation of the nearest points in the
  /// plane, along the axis where it is smaller].
  float height = 0.0F;
};

/// The star of each node: its Voronoi neighbours in its tangent plane, or its neighbours in the
/// Gabriel graph if the nearest points span no plane.
struct Stars {
  Indexed<Star> of_node;
  std::vector<Index> nodes;

  std::size_t size() const { return of_node.size(); }
  const Star& operator[](Index i) const { return of_node[i]; }
  Row<Index> of(Index i) const {
    const Index* begin = nodes.data() + of_node[i].begin;
    return {begin, begin + of_node[i].count};
  }
};

/// Finds the stars of all nodes. A star is certified if no point beyond the list can change it: the
/// list reaches twice the radius of the Voronoi cell. For uncertified stars more neighbours are
/// searched, once a round for all of them. If the nearest neighbours span no plane (a line, all
/// directions alike, too few points), the star is that of the Gabriel graph of the list (Gabriel
/// and Sokal 1969).
///
/// Where the stars of an area disagree because of another sheet, they are found without the
/// candidates on that sheet; the new stars stay if more edges are then in the stars of both ends.
/// This needs a search. Not guaranteed for random samples of sheets closer than two spacings.
///
/// \param points    3 x n, finite, distinct.
/// \param neighbors of the nodes.
/// \param execution threads, progress
/// \return the stars; the same, bit by bit, for any number of threads.
/// Cost: O(n c log c) for lists of c points.
Stars findStars(const Positions& points, const Neighbors& neighbors, const Execution& execution);

/// The fraction of the entries of all stars that the other star does not have; 0 without entries.
double oneSidedFraction(const Stars& stars, int threads = 1, const FractionReport& report = {});

}  // namespace spherical_param::internal
