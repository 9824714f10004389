#pragma once

#include "graph.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <cstdint>
#include <vector>

namespace spherical_param {

/// An embedding of a graph on the unit sphere.
struct Embedding {
  Positions directions;    ///< 3 x n, unit vectors, column i = node i
  EmbeddingReport report;  ///< convergence and levels
};

/// Embeds a graph on the unit sphere so that the tangential Laplacian vanishes:
/// L - (L . u_i) u_i with L = sum_j w_ij (u_j - u_i) and the adaptive weights of Zwicker and
/// Gotsman 2004 (equations 1, 2 and 4). Their iteration has the critical points of an energy as its
/// fixed points,
///
///   E(u) = sum over edges  |u_i - u_j|^3 / (3 |p_i - p_j|),
///
/// whose gradient is minus the tangential Laplacian, times the sum of the weights at each node. It
/// is lowered from coarse to fine:
///
/// 1. Coarsest level: a planar embedding of the graph (Tutte 1963) around a central node, lifted to
///    the sphere, is unfolded; Newton's method on the product of spheres solves it. Of several
///    starts the one of least energy is kept; collapsed starts (all nodes at one place) are
///    rejected.
/// 2. Up: positions are interpolated and smoothed by a few damped sweeps; small levels are solved
///    fully, so that even their smallest parts converge.
/// 3. With a `tolerance`, the finest level is solved too: Newton's method, each step by conjugate
///    gradients with a V-cycle on the same levels as preconditioner. The number of steps does not
///    grow with the graph, so the time is nearly linear.
///
/// Collapse. The collapsed state has energy 0; pulling the sphere over a node or an edge stretches
/// the map there and costs energy. On graphs of a few nodes or with wide gaps this does not hold
/// the sphere. Then a barrier -b log(1 - |c|^2) is added, with the energy b and the centroid c of
/// the nodes, weighted by their areas on the sphere (both from the start of each level), or finer
/// levels are tried, \see attemptsOf. An embedding that still collapses is replaced, \see
/// internal::projectFromCentroid.
///
/// \param graph   n nodes, connected, with positive edge lengths.
/// \param points  3 x n, finite: the points that the nodes stand for.
/// \param options when to end
/// \param seed    of the coarse graphs.
/// \param execution threads, progress
/// \return the embedding, the same, bit by bit, for any number of threads.
/// \throw Cancelled.
/// Cost: O(edges) for each sweep; with a tolerance about five times as long as without.
///
/// No guarantees: a graph with shortcuts, holes or articulation points may fold or collapse. Along
/// a limb of radius r the map shrinks like exp(-s / (r sqrt(2))): tips beyond some 40 radii from
/// the widest part approach the rounding of double, and beyond 50 they coincide.
Embedding embed(const Graph& graph, const Positions& points, const EmbeddingOptions& options = {},
                std::uint32_t seed = 1, const Execution& execution = {});

/// Length of the tangential Laplacian of an embedding at each node [radius of the sphere].
///
/// \param directions 3 x n, unit vectors.
std::vector<double> tangentialLaplacianLengths(const Graph& graph, const Positions& directions,
                                               EdgeWeights weights);

/// The mean of tangentialLaplacianLengths(); 0 without nodes.
double meanTangentialLaplacian(const Graph& graph, const Positions& directions,
                               EdgeWeights weights);

namespace internal {

/// Projects points from their centroid onto the unit sphere: the start of the iteration in Figure 3
/// of the paper, and the embedding where all attempts collapse. A point at the centroid gets a
/// fixed direction.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectFromCentroid(const Positions& points);

/// Whether an embedding with this centroid is at one place of the sphere. NaN counts as collapsed.
bool isCollapsed(const Eigen::Vector3d& centroid);

}  // namespace internal
}  // namespace spherical_param
