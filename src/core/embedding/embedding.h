#pragma once

#include "graph.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <cstdint>
#include <vector>

namespace spherical_param {

/// \addtogroup embedding
/// @{

/// An embedding of a graph on the unit sphere.
struct Embedding {
  Positions directions;      ///< 3 x n, unit vectors, column i = node i
  EmbeddingReport report;    ///< convergence and levels
  EmbeddingHistory history;  ///< empty without EmbeddingOptions::history_vertices

  // Only of EmbeddingMethod::Multilevel.

  int starts = 0;            ///< number of starts tried, on all levels
  int collapsed_starts = 0;  ///< number of starts rejected as collapsed
  double energy = 0.0;       ///< without barrier
};

/// How Multilevel weights the nodes in the centroid that shows a collapse.
enum class NodeMass {
  Equal,   ///< equally
  ByArea,  ///< by the mean squared length of their edges, for unevenly spread nodes
};

/// Embeds a graph on the unit sphere so that the tangential Laplacian vanishes:
/// L - (L . u_i) u_i with L = sum_j w_ij (u_j - u_i) (Zwicker and Gotsman 2004, equations 1, 2).
///
/// Iterative (their Figure 3): the points are projected from their centroid. Then, repeatedly:
/// centre so that the sum is 0; project on the sphere; add `damping` times the tangential Laplacian
/// to each point (all at once, Jacobi) and normalise.
///
/// Multilevel: a fixed point of that iteration is a critical point of an energy of the embedding u.
/// With adaptive weights (equation 4) the energy is
///
///   E(u) = sum over edges  |u_i - u_j|^p / (p |p_i - p_j|^(p - 2)),   p = 3,
///
/// and with weights w that do not depend on u it is the sum of w |u_i - u_j|^2 / 2 (p = 2). Its
/// gradient is minus the tangential Laplacian, times the sum of the weights at each node. It is
/// lowered level by level:
///
/// 1. Coarsest level: a planar embedding of the graph (Tutte 1963) around a central node, lifted to
///    the sphere, is unfolded; Newton's method on the product of spheres solves it. Of several
///    starts the one of least energy is kept; collapsed starts (all nodes at one place) are
///    rejected. If all collapse, as on graphs of a few nodes or with wide gaps, a barrier (below)
///    is added. If the barrier pulls hard, finer levels are first tried without it.
/// 2. Up: positions are interpolated and smoothed by a few damped sweeps; small levels are solved
///    fully, so that even their smallest parts converge.
/// 3. With a `tolerance`, the finest level is solved too: Newton's method, each step by conjugate
///    gradients with a V-cycle on the same levels as preconditioner. The number of steps does not
///    grow with the graph, so the time is nearly linear.
///
/// Collapse. The collapsed state has energy 0. For p > 2 an energy barrier prevents it: pulling the
/// sphere over a node or an edge stretches the map there. For p = 2 there is no barrier: up to
/// discretisation the energy is invariant under conformal maps, some of which draw all nodes to one
/// place. For uniform and inverse-length weights the start is therefore solved with adaptive
/// weights, and a barrier -b log(1 - |c|^2) is added, with the energy b and the centroid c of the
/// nodes, weighted by their areas on the sphere (both from the start of each level). It selects a
/// map that is not collapsed; the tangential Laplacian then vanishes only together with its pull.
/// An embedding that still collapses is replaced, \see internal::projectByRank.
///
/// \param graph   n nodes, connected, with positive edge lengths.
/// \param points  3 x n, finite: the points that the nodes stand for.
/// \param options method, weights, when to end, history
/// \param seed    of the coarse graphs of Multilevel.
/// \param execution threads, progress
/// \return the embedding, the same, bit by bit, for any number of threads.
/// \throw Cancelled.
/// Cost: O(edges) for each iteration or sweep; with a tolerance about five times that of Multilevel
/// without.
///
/// No guarantees: a graph with shortcuts, holes or articulation points may fold or collapse; limbs
/// that the projection of Iterative folds stay folded. Along a limb of radius r the map shrinks
/// like exp(-s / (r sqrt(p - 1))): tips beyond some 40 radii from the widest part approach the
/// rounding of double, and beyond 50 they coincide.
Embedding embed(const Graph& graph, const Positions& points, const EmbeddingOptions& options = {},
                std::uint32_t seed = 1, const Execution& execution = {},
                NodeMass mass = NodeMass::Equal);

/// Length of the tangential Laplacian of an embedding at each node [radius of the sphere], computed
/// independently of the solvers.
///
/// \param graph       as for embed().
/// \param directions  3 x n, unit vectors.
/// \param weights     of the Laplacian.
/// \param exponent    p of the energy of adaptive weights.
/// \return n entries.
std::vector<double> tangentialLaplacianLengths(const Graph& graph, const Positions& directions,
                                               EdgeWeights weights, double exponent = 3.0);

/// The mean of tangentialLaplacianLengths().
///
/// \param graph, directions, weights, exponent as there.
/// \return 0 without nodes.
double meanTangentialLaplacian(const Graph& graph, const Positions& directions, EdgeWeights weights,
                               double exponent = 3.0);

/// @}

}  // namespace spherical_param
