#pragma once

#include "embedding.h"
#include "graph.h"
#include "spherical_param/execution.h"
#include "spherical_param/options.h"
#include "spherical_param/types.h"

/// The method as published: M. Zwicker and C. Gotsman, "Meshing Point Clouds Using Spherical
/// Parameterization", Eurographics Symposium on Point-Based Graphics, 2004. Its three steps are the
/// three functions. They share equation 2 and the damped sweep with the default method, and its
/// exact triangulation where qhull leaves out points.
namespace spherical_param::internal::paper {

/// Section 3: the k-nearest-neighbour graph. Its components are joined along their minimum spanning
/// tree: without, each would collapse to a place of its own.
///
/// \param points 3 x n, distinct.
/// \param lists  of the neighbours of each point; the point itself may be among them.
NeighborGraph nearestNeighborGraph(const Positions& points, const NeighborLists& lists, int k);

/// Section 3, Figure 3: from the projection of the points from their centroid, the iteration moves
/// each by a damped step along the tangential Laplacian, centres and projects all on the sphere,
/// until the tangential Laplacian vanishes.
///
/// \param graph     n >= 1 nodes, connected.
/// \param points    3 x n, finite.
/// \param tolerance mean length of the tangential Laplacian at convergence [radius].
/// \return the embedding; StopReason::Collapsed if nearly all points are at one place.
/// Cost: O(edges) for each iteration.
Embedding embed(const Graph& graph, const Positions& points, const PaperOptions& options,
                double tolerance, const Execution& execution);

/// Section 3: the convex hull of the points on the sphere, by qhull. It leaves out points closer
/// than its round-off; their exact Delaunay triangulation, which is the same hull, takes its place.
///
/// \param directions 3 x n, unit vectors, n >= 4.
/// \return 3 x (2n - 4), outward on the sphere: closed, manifold, of genus 0, over all points.
/// \throw ComputeError if qhull runs out of memory.
Triangles convexHull(const Positions& directions, const Execution& execution);

}  // namespace spherical_param::internal::paper
