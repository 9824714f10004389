#pragma once

#include "graph.h"
#include "tangent_stars.h"

namespace spherical_param::internal {

/// The agreed graph: its edges join nodes that are in each other's star, without repairs and
/// bridges. Its components are surfaces, or stray points.
Graph agreedGraph(const Positions& points, const Stars& stars, const Execution& execution);

/// The tangent Delaunay graph (Method::Default), connected.
///
/// The nearest neighbours of a point are laid into its tangent plane at their true distances; its
/// star is the set of its Voronoi neighbours there. Points i and j are joined if both stars agree.
/// Points with fewer than three neighbours get their whole star and their three nearest points.
/// Components are joined along their closest pairs, with up to three bridges with different ends.
/// So are biconnected components: one that hangs by an articulation point would collapse in the
/// embedding.
///
/// Cost: O(p log p log n) for the bridges of p components, typically.
/// Guaranteed: the graph is connected; with four points and more, each has at least three
/// neighbours. Not guaranteed: no shortcuts between sheets that are closer than their points; no
/// articulation points in a chain of them (a needle).
///
/// \param points 3 x n, finite, distinct.
/// \param stars  of these points.
/// \param agreed \see agreedGraph
/// \return the graph, without stray points.
NeighborGraph buildLocalDelaunayGraph(const Positions& points, const Stars& stars, Graph agreed,
                                      const Execution& execution);

}  // namespace spherical_param::internal
