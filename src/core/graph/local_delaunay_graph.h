#pragma once

#include "neighbor_graph.h"
#include "tangent_stars.h"

namespace spherical_param::internal {

/// The graph of the pairs of nodes that are in each other's star, before anything is repaired or
/// joined. Its components are the surfaces of a cloud, and what belongs to none.
Graph agreedGraph(const Positions& points, const Stars& stars, const Execution& execution);

/// Whether stray points are looked for.
enum class StraySearch { No, Yes };

/// The graph of local Delaunay neighbourhoods (GraphMethod::LocalDelaunay), connected.
///
/// The nearest neighbours of a point are laid into its tangent plane at their true distances; its
/// star is the set of its Voronoi neighbours there. Points i and j are joined if both stars agree.
/// Points with fewer than three neighbours get their whole star and their three nearest. Components
/// are joined by the shortest edges of stars, then along their closest pairs; each two that are
/// joined get up to three bridges with different ends, and so do biconnected components: one that
/// hangs by an articulation point collapses in the embedding.
///
/// Cost: O(p log p log n) for the bridges of p components, typically.
/// Guaranteed: the graph is connected; of four points and more, each has at least three neighbours.
/// Not guaranteed: that no edge is a shortcut where sheets are closer to each other than their
/// points, nor that a chain of parts that hang by one node each (a needle) is tied everywhere.
///
/// \param points 3 x n, finite, distinct.
/// \param stars  of these points.
/// \param strays whether GraphReport::stray_points are looked for.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const Stars& stars,
                                      StraySearch strays, const Execution& execution);

}  // namespace spherical_param::internal
