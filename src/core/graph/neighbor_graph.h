#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <cstddef>
#include <vector>

namespace spherical_param {

/// \addtogroup neighbor_graph
/// @{

/// An edge that joins two parts of a graph that was in pieces.
struct Bridge {
  Index from;     ///< node in one part
  Index to;       ///< node in the other part
  double length;  ///< distance of the two points [unit of the input]
};

/// A point that belongs to no surface. \see findStrayPoints
struct StrayPoint {
  Index point;      ///< its number
  double distance;  ///< to the nearest surface [mean distance of neighbours there]
};

/// What it took to connect a neighbour graph.
struct GraphReport {
  std::size_t edges = 0;        ///< undirected edges, bridges included
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< edges that join them, in the order of their insertion

  // Of GraphMethod::LocalDelaunay alone. Its bridges also tie biconnected components together.

  /// Points without a reliable tangent plane, ascending: their neighbours are those of the Gabriel
  /// graph, which needs none.
  std::vector<Index> without_tangent_plane;
  Index searched_again = 0;  ///< points for which more neighbours were searched
  Index uncertified = 0;     ///< points with a tangent plane whose cell is not certified even so
  Index weak = 0;            ///< points of which fewer than three edges were agreed on, repaired
  std::vector<StrayPoint> stray_points;  ///< ascending; nodes of the graph, as all others are
};

/// A connected neighbour graph.
struct NeighborGraph {
  Graph graph;         ///< connected
  GraphReport report;  ///< how it came about
};

/// Builds the symmetric, connected neighbour graph of a point cloud.
///
/// GraphMethod::NearestNeighbors: points i and j are joined if j is among the k nearest of list i,
/// or i among the k nearest of list j. Components are then joined along the minimum spanning tree
/// of the components (Boruvka 1926), because a graph in pieces collapses the embedding.
///
/// GraphMethod::LocalDelaunay: the nearest neighbours of a point are laid into its tangent plane at
/// their true distances; its star is the set of its Voronoi neighbours there. Points i and j are
/// joined if both stars agree. A star is certified if no point outside of the list can change it:
/// twice the radius of the Voronoi cell is within the list. `search` is asked for more where it is
/// not, once a round for all such points together. Where the nearest neighbours span no plane (a
/// line, all directions alike, too few points), the star is that of the Gabriel graph of the list
/// (Gabriel and Sokal 1969). Points with fewer than three neighbours get their whole star and their
/// three nearest. Components are joined by the shortest edges of stars, then along their closest
/// pairs; each two that are joined get up to three bridges with different ends, and so do
/// biconnected components: one that hangs by an articulation point collapses in the embedding.
///
/// \param points 3 x n, finite, distinct.
/// \param lists  n neighbour lists, the nearest of each point; unsorted, with or without the point
///               itself, of any length. neighborsToSearch() neighbours are mostly enough.
/// \param options method, k, agreement of stars
/// \param search asked for longer lists of some points by local Delaunay neighbourhoods. May be
///               empty: the graph is then made of the lists alone.
/// \param execution threads, progress
/// \return the graph; the same, bit by bit, for any number of threads.
/// \throw Cancelled.
/// Cost: O(n c log c) for lists of c points, and O(p log p log n) for the bridges of p components,
/// typically.
///
/// Guaranteed: the graph is connected; with local Delaunay neighbourhoods of four points and more,
/// each has at least three neighbours.
/// Not guaranteed: that no edge is a shortcut where sheets are closer to each other than their
/// points, nor that a chain of parts that hang by one node each (a needle) is tied everywhere.
NeighborGraph buildNeighborGraph(const Positions& points, const NeighborLists& lists,
                                 GraphMethod method, int k, const NeighborSearch& search = {},
                                 const Execution& execution = {});

/// @}

}  // namespace spherical_param
