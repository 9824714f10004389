#pragma once

#include "spherical_param/graph_hierarchy.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace spherical_param {

/// \addtogroup embedding
/// @{

/// How a graph is embedded on the sphere.
enum class EmbeddingMethod {
  Iterative,   ///< the iteration of Zwicker and Gotsman 2004, Figure 3: embedOnSphere()
  Multilevel,  ///< from coarse to fine graphs, unfolded: embedMultilevel()
};

/// Weights of the Laplacian (Zwicker and Gotsman 2004, section 3, equations 2 to 4), normalised so
/// that they sum to 1 at each node.
enum class EdgeWeights {
  Uniform,        ///< w_ij = 1
  InverseLength,  ///< w_ij = 1 / |p_i - p_j|
  /// w_ij = (|u_i - u_j| / |p_i - p_j|)^(p - 2), recomputed in each iteration; equation 4 for p = 3
  Adaptive,
};

/// Why the iteration ended.
enum class StopReason {
  Converged,       ///< the residual is at most the tolerance
  IterationLimit,  ///< `max_iterations` steps were made
  Stagnated,       ///< the residual no longer changes, or rounding allows no further step
  Collapsed,       ///< nearly all points are at one place of the sphere: not an embedding
  Unfinished,      ///< convergence was not asked for: the last smoothing sweep was made
};

/// What was done last to a state of an embedding.
enum class EmbeddingStep {
  Start,      ///< nothing yet on this level: the very start, or what came from the coarser level
  Sweeps,     ///< the smoothing sweeps of a level
  Newton,     ///< a step of Newton's method; number 0 is the state before the first
  Iteration,  ///< a step of embedOnSphere(); number 0 is the state before the first
  End,        ///< the embedding that is returned
};

/// A state of an embedding on its way to the result, as an observer is shown it.
struct EmbeddingState {
  std::size_t level = 0;  ///< of the hierarchy: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of the level
  EmbeddingStep step = EmbeddingStep::Start;  ///< kind of the work before it
  int iteration = 0;                          ///< steps of this kind that were made on this level
  std::optional<double>
      residual;  ///< mean tangential Laplacian, where the solver knows it [radius]
  /// Makes a copy of the state, 3 x nodes, unit vectors; to be called before the observer returns.
  /// Many states are shown: ask for those alone that are of use.
  std::function<Positions()> directions;
};

/// Shown the states of an embedding one after the other, from the calling thread only. What it
/// throws is passed on. The result is the same, bit by bit, whether somebody looks or not.
using EmbeddingObserver = std::function<void(const EmbeddingState&)>;

/// Parameters of embedOnSphere().
struct EmbeddingOptions {
  EdgeWeights weights = EdgeWeights::Adaptive;  ///< weights of the Laplacian
  double lambda = 0.5;        ///< damping, share of the tangential Laplacian per step; (0, 1]
  int max_iterations = 1600;  ///< steps at most, as in Table 1 of the paper; >= 0
  /// Mean length of the tangential Laplacian at which the embedding counts as converged [radius of
  /// the sphere]; >= 0 (0: only an exact fixed point does).
  double tolerance = 1e-8;
  /// Stagnation: the residual varied by less than `stagnation_change` (relative) over the last
  /// `stagnation_window` iterations. Window >= 2; 0 switches the test off.
  int stagnation_window = 100;
  double stagnation_change = 1e-5;  ///< relative; >= 0
  int threads = 0;                  ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Called with (iteration, residual) after each evaluation of the residual; returning false
  /// ends the work with Cancelled. May be empty. Called from the calling thread only.
  std::function<bool(int, double)> progress;
  EmbeddingObserver observer = {};  ///< shown every iteration, and the end; may be empty
};

/// An embedding of a graph on the unit sphere and how it was reached.
struct Embedding {
  Positions directions;                                 ///< 3 x n, unit vectors, column i = node i
  StopReason stop_reason = StopReason::IterationLimit;  ///< why it ended
  int iterations = 0;                                   ///< steps made
  double residual = 0.0;  ///< mean length of the tangential Laplacian at `directions` [radius]
  /// Mean length of the tangential Laplacian before each step, and of the last state:
  /// iterations + 1 entries (Figures 6 and 7 of the paper).
  std::vector<double> residuals;
  double centroid_norm = 0.0;  ///< length of the mean of `directions`, in [0, 1]; 1: collapsed

  /// Whether the tolerance was reached. \return true if it was
  bool converged() const { return stop_reason == StopReason::Converged; }
};

/// Projects points from their centroid onto the unit sphere: the start of the iteration in Figure 3
/// of the paper. A point at the centroid itself is given a fixed direction.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectFromCentroid(const Positions& points);

/// Directions that are never collapsed, whatever the points: the rank of a point along the cloud's
/// longest axis gives the height on the sphere (equal areas, Archimedes), the angle around that
/// axis its longitude. The start of last resort.
///
/// \param points 3 x n, finite.
/// \return 3 x n, unit vectors.
Positions projectByRank(const Positions& points);

/// Embeds a graph on the unit sphere by the iteration of Zwicker and Gotsman 2004, Figure 3:
/// centre so that the sum is 0; project on the sphere; add lambda times the tangential Laplacian
/// to each point (all at once, Jacobi) and normalise; repeat.
///
/// The tangential Laplacian is L - (L . u_i) u_i with L = sum_j w_ij (u_j - u_i) (equations 1, 2).
///
/// \param graph      connected, with positive edge lengths.
/// \param start      3 x n, finite: the points themselves (u = p) or any other start.
/// \param options weights, damping, when to end, threads, progress
/// \return the last state. The result is bit-identical for any number of threads.
/// \throw InvalidInput for sizes that disagree or options out of range; Cancelled.
/// Cost: O(edges) per iteration.
///
/// No guarantees: limbs that the projection folds stay folded; the residual need not vanish; the
/// uniform weights may collapse slowly (reported as StopReason::Collapsed).
Embedding embedOnSphere(const Graph& graph, const Positions& start,
                        const EmbeddingOptions& options = {});

/// Parameters of embedMultilevel().
struct MultilevelOptions {
  EdgeWeights weights = EdgeWeights::Adaptive;  ///< weights of the Laplacian
  double exponent = 3.0;                        ///< p of the energy of adaptive weights; (2, 16]
  double lambda = 0.5;                          ///< damping of the smoothing sweeps; (0, 1]
  int sweeps = 10;                              ///< smoothing sweeps on each level; >= 0
  /// Levels of at most so many nodes are solved fully, not only smoothed; >= 0.
  Index solved_size = 10000;
  /// Mean length of the tangential Laplacian to which the finest level is solved [radius of the
  /// sphere]; >= 0. Unset: the finest level is smoothed like the others.
  std::optional<double> tolerance;
  int starts = 2;   ///< of the coarsest level; the one of least energy is kept; 1 to 100
  int threads = 0;  ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Called with (share done in [0, 1], residual of the level at hand); returning false ends the
  /// work with Cancelled. May be empty. Called from the calling thread only.
  std::function<bool(double, double)> progress;
  /// Shown the start that is kept and each step of its solution, then each finer level as it is
  /// interpolated, after its sweeps, and at each step of Newton's method, and the end. May be
  /// empty. The coarsest level is solved once more for it. Where a level collapses, its states are
  /// followed by those of the solution with a barrier.
  EmbeddingObserver observer = {};
};

/// Work on one level of a multilevel embedding.
struct LevelReport {
  std::size_t nodes = 0;      ///< of the level's graph
  std::size_t edges = 0;      ///< undirected
  int sweeps = 0;             ///< smoothing sweeps
  int newton_iterations = 0;  ///< steps of Newton's method
  int linear_iterations = 0;  ///< conjugate gradient steps within these
  double residual = 0.0;      ///< mean length of the tangential Laplacian at the end [radius]
};

/// An embedding by levels.
struct MultilevelEmbedding {
  Positions directions;  ///< 3 x n, unit vectors, column i = node i
  /// Unfinished without a tolerance; else Converged if the residual is at most that. A barrier
  /// mostly keeps it above, by its pull: Stagnated.
  StopReason stop_reason = StopReason::Unfinished;
  double residual = 0.0;       ///< mean length of the tangential Laplacian at `directions` [radius]
  double energy = 0.0;         ///< that of the weights, without barrier, at `directions`
  double centroid_norm = 0.0;  ///< length of the mean of `directions`, in [0, 1]; 1: collapsed
  int starts = 0;              ///< starts of the coarsest level that were tried
  int collapsed_starts = 0;    ///< of these, collapsed and rejected
  /// All starts collapsed, so that a barrier was added to adaptive weights as well.
  bool added_barrier = false;
  std::vector<LevelReport> levels;  ///< the finest (the graph itself) first
  std::vector<double> residuals;    ///< of the finest level, before each Newton step and at the end

  /// Whether the tolerance was reached. \return true if it was
  bool converged() const { return stop_reason == StopReason::Converged; }
};

/// Embeds a graph on the unit sphere from coarse to fine, so that the result is unfolded.
///
/// A fixed point of the iteration of Zwicker and Gotsman 2004 is a critical point of an energy of
/// the embedding u: with adaptive weights (their equation 4) of
///
///   E(u) = sum over edges  |u_i - u_j|^p / (p |p_i - p_j|^(p - 2)),   p = 3,
///
/// with weights w that do not depend on u of sum w |u_i - u_j|^2 / 2 (p = 2). Its gradient is minus
/// the tangential Laplacian, times the sum of the weights at each node. It is lowered level by
/// level:
///
/// 1. Coarsest level: a planar embedding of the graph (Tutte 1963) around a central node, lifted to
///    the sphere, is unfolded; Newton's method on the product of spheres solves it. Of several
///    starts the one of least energy is kept; collapsed ones (all nodes around one place) are
///    rejected, and if all collapse the next finer level is tried. If those collapse too, as on
///    graphs of a few nodes or with wide gaps, a barrier (below) is added.
/// 2. Up: positions are interpolated and smoothed by a few damped sweeps; levels of at most
///    `solved_size` nodes are solved fully, so that even their smallest parts come to rest.
/// 3. With a `tolerance`, the finest level is solved too: Newton's method, each step by conjugate
///    gradients with a V-cycle on the same levels as preconditioner. The number of steps does not
///    grow with the graph, so that the time is near-linear.
///
/// Collapse. For p > 2 it costs energy to pull the sphere over a node or an edge, since the map has
/// to be stretched there: a barrier stands between the embedding and the collapsed state, whose
/// energy is 0. For p = 2 there is none: up to discretisation the energy is invariant under
/// conformal maps, among them those that draw all nodes to one place. For uniform and
/// inverse-length weights the start is therefore solved with adaptive weights, and a barrier -b
/// log(1 - |c|^2) is added, b the energy and c the centroid of the nodes, weighted by their areas
/// on the sphere (both as each level finds them): of all maps that differ by a conformal one it
/// picks one that is not collapsed. What vanishes is the tangential Laplacian together with the
/// pull of that barrier.
///
/// \param graph     connected, with positive edge lengths.
/// \param hierarchy of that graph. Coarsest levels of some hundred nodes suit best.
/// \param options weights, exponent, sweeps, tolerance, starts, threads, progress
/// \return the embedding, the same, bit by bit, for any number of threads. If all starts collapse
///         even with a barrier: StopReason::Collapsed and no columns.
/// \throw InvalidInput for a hierarchy of another graph or options out of range; Cancelled.
/// Cost: O(edges) for the sweeps; the finest solution about five times as much.
///
/// No guarantees: a graph with shortcuts, holes or pieces that hang by a single node may fold or
/// collapse. Along a limb of radius r the map shrinks like exp(-s / (r sqrt(p - 1))): tips further
/// than some 40 radii from the widest part come close to the rounding of double, and beyond 50 they
/// coincide.
MultilevelEmbedding embedMultilevel(const Graph& graph, const GraphHierarchy& hierarchy,
                                    const MultilevelOptions& options = {});

/// Length of the tangential Laplacian of an embedding at each node [radius of the sphere], computed
/// apart from the solvers, one edge after the other.
///
/// \param graph       as for embedOnSphere().
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
