#pragma once

#include "spherical_param/types.h"

#include <functional>
#include <vector>

namespace spherical_param {

/// \addtogroup neighbor_graph
/// @{

/// How points become neighbours.
enum class GraphMethod {
  NearestNeighbors,  ///< k nearest neighbours (Zwicker and Gotsman 2004, section 3)
  LocalDelaunay,     ///< local Delaunay neighbourhoods (the future work of their section 6)
};

/// Answers with the `count` nearest neighbours of each of `points`, one list for each in their
/// order. The point itself may be in its list; `count` should not include it. Lists may be shorter
/// where there are no more.
using NeighborSearch = std::function<NeighborLists(const std::vector<Index>& points, int count)>;

/// Parameters of buildNeighborGraph().
struct NeighborGraphOptions {
  /// Nearest neighbours used of each list (k of Zwicker and Gotsman 2004, section 3); lists that
  /// hold fewer are used whole. Range: 3 and up.
  int k = 25;
};

/// An edge that joins two parts of a graph that was in pieces.
struct Bridge {
  Index from;     ///< node in one part
  Index to;       ///< node in the other part
  double length;  ///< distance of the two points [unit of the input]
};

/// A connected neighbour graph, and what it took to connect it.
struct NeighborGraph {
  Graph graph;                  ///< connected
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< edges that join them, in the order of their insertion

  // Of buildLocalDelaunayGraph() alone. Its bridges also tie parts that a single node joins.

  /// Points without a trustworthy tangent plane, ascending: their neighbours are those of the
  /// Gabriel graph, which needs none.
  std::vector<Index> without_tangent_plane;
  Index searched_again = 0;  ///< points for which more neighbours were asked
  Index uncertified = 0;     ///< points with a tangent plane whose cell is not certified even so
  Index weak = 0;            ///< points that fewer than three neighbours agreed with, repaired
};

/// Which pairs of points local Delaunay neighbourhoods join.
enum class StarAgreement {
  Both,    ///< those of which each is in the star of the other
  Either,  ///< those of which one is in the star of the other: more edges, and more shortcuts
};

/// Parameters of buildLocalDelaunayGraph().
struct LocalDelaunayOptions {
  StarAgreement agreement = StarAgreement::Both;  ///< of the stars of two points
  /// Nearest neighbours that span the tangent plane; more where these are on a line; 3 and up.
  int tangent_neighbors = 10;
  /// Candidates steeper than this to the tangent plane are on another sheet [sine of the angle];
  /// (0, 1].
  double max_slope = 0.85;
  /// Nearest neighbours used of a list, and asked of `search`, at most; tangent_neighbors and up.
  int max_candidates = 32;
  int threads = 0;  ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Asked for more neighbours of points whose cell is not certified by those it has. May be empty:
  /// the graph is then made of the lists alone.
  NeighborSearch search;
  /// Called with the share of the work that is done, in [0, 1], which never falls; returning false
  /// ends the work with Cancelled. May be empty. Called from the calling thread only.
  std::function<bool(double)> progress = {};
};

/// Builds the symmetric, connected neighbour graph of a point cloud.
///
/// Points i and j are joined if j is among the k nearest of list i, or i among the k nearest of
/// list j. Components are then joined along the minimum spanning tree of the components (Boruvka's
/// algorithm on a k-d tree), because a graph in pieces collapses the embedding.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists; unsorted, longer or shorter than k, and with the point itself.
/// \param options k
/// \return the graph, and the edges that joined its components.
/// \throw InvalidInput for sizes that disagree, an index out of range, or k < 3.
/// Cost: O(n k log k) and O(c log c log n) for the bridges of c components, typically.
NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 const NeighborGraphOptions& options = {});

/// Builds a connected neighbour graph from local Delaunay neighbourhoods.
///
/// The nearest neighbours of a point are laid into its tangent plane at their true distances; its
/// star is the set of its Voronoi neighbours there. Points i and j are joined if both stars agree.
/// A star is certified if no point outside of the list can change it: twice the radius of the
/// Voronoi cell is within the list; `search` is asked for more where it is not, once a round for
/// all such points together. StarAgreement::Either joins them if one star is enough.
///
/// Where the nearest neighbours span no plane (a line, all directions alike, too few points), the
/// star is that of the Gabriel graph of the list (Gabriel and Sokal 1969).
///
/// Points with fewer than three neighbours get their whole star and their three nearest. Parts are
/// joined by the shortest edges of stars, then along their closest pairs; each two that are joined
/// get up to three bridges with different ends, and so do parts that a single node joins: what
/// hangs by one node collapses in the embedding.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists, the nearest of each point; unsorted, with or without the point
///               itself. 12 nearest neighbours are mostly enough.
/// \param options agreement of stars, tangent planes, search for more, threads, progress
/// \return the graph; the same, bit by bit, for any number of threads.
/// \throw InvalidInput for sizes that disagree, an index out of range, or options out of range;
/// Cancelled.
/// Cost: O(n c log c) for lists of c points, typically.
///
/// Guaranteed: the graph is connected; of four points and more, each has at least three neighbours.
/// Not guaranteed: that no edge is a shortcut where sheets are closer to each other than their
/// points, nor that a chain of parts that hang by one node each (a needle) is tied everywhere.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      const LocalDelaunayOptions& options = {});

/// @}

}  // namespace spherical_param
