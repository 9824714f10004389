#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace spherical_param {

/// \addtogroup embedding
/// @{

/// How a graph is embedded on the sphere.
enum class EmbeddingMethod {
  Iterative,   ///< the iteration of Zwicker and Gotsman 2004, Figure 3
  Multilevel,  ///< from coarse to fine graphs, unfolded
};

/// Weights of the Laplacian (Zwicker and Gotsman 2004, section 3, equations 2 to 4), normalised so
/// that they sum to 1 at each node.
enum class EdgeWeights {
  Uniform,        ///< w_ij = 1
  InverseLength,  ///< w_ij = 1 / |p_i - p_j|
  /// w_ij = (|u_i - u_j| / |p_i - p_j|)^(p - 2), recomputed in each iteration; equation 4 for p = 3
  Adaptive,
};

/// Why the work on an embedding ended.
enum class StopReason {
  Converged,       ///< the residual is at most the tolerance
  IterationLimit,  ///< `max_iterations` steps were made
  Stagnated,       ///< the residual no longer changes, or rounding allows no further step
  Collapsed,       ///< nearly all points are at one place of the sphere: not an embedding
  Unfinished,      ///< convergence was not asked for: the last smoothing sweep was made
};

/// How much of an embedding's history is kept.
struct HistoryLimits {
  /// Nodes of the graph whose paths are kept, at most; 0: no history; [0, 2^24].
  Index vertices = 0;
  /// States at most; [2, 10000]. Of more, some between the first and the last are left out.
  int frames = 40;
};

/// What was done last to a state of an embedding.
enum class EmbeddingStep {
  Start,      ///< nothing yet on this level: the very start, or what came from the coarser level
  Sweeps,     ///< the smoothing sweeps of a level
  Newton,     ///< a step of Newton's method; number 0 is the state before the first
  Iteration,  ///< a step of EmbeddingMethod::Iterative; number 0 is the state before the first
  End,        ///< the embedding that is returned
};

/// One state of an embedding.
struct HistoryFrame {
  std::size_t level = 0;  ///< that was worked on: 0 is the graph itself, 1 the next coarser
  std::size_t nodes = 0;  ///< of that level
  EmbeddingStep step = EmbeddingStep::Start;  ///< kind of the work before it
  int iteration = 0;                          ///< steps of this kind that were made on this level
  std::optional<double> residual;  ///< mean tangential Laplacian, where it is known [radius]
  Positions sphere;                ///< 3 x EmbeddingHistory::vertices.size(), unit vectors
};

/// How an embedding unfolded, for some of its nodes.
struct EmbeddingHistory {
  std::vector<Index> vertices;       ///< nodes of the graph; in a Result: vertices
  std::vector<HistoryFrame> frames;  ///< in the order of the work; the last is the embedding
};

/// Parameters of embed().
struct EmbeddingOptions {
  EmbeddingMethod method = EmbeddingMethod::Multilevel;  ///< how the graph is embedded
  EdgeWeights weights = EdgeWeights::Adaptive;           ///< weights of the Laplacian
  /// p of the energy that adaptive weights minimise, sum |u_i - u_j|^p / (p |p_i - p_j|^(p - 2));
  /// (2, 16]. 3 gives the weights of the paper, and is all that the iteration knows.
  double exponent = 3.0;
  /// Fraction of the tangential Laplacian by which iteration and smoothing sweeps move each point;
  /// (0, 1].
  double damping = 0.5;
  /// Mean length of the tangential Laplacian at which the embedding counts as converged [radius of
  /// the sphere]; [0, 1]. Unset: 1e-8 for the iteration; Multilevel then ends with its sweeps.
  std::optional<double> tolerance;
  /// Steps of the iteration at most, as in Table 1 of the paper; >= 0. With 0 the embedding is the
  /// projection of the points from their centroid.
  int max_iterations = 1600;
  /// Iterations over which stagnation is judged; 0 or 1: never; >= 0.
  int stagnation_window = 100;
  /// Starts of Multilevel on the coarsest level, of which the one of least energy is kept; 1 to
  /// 100.
  int starts = 2;
  /// Multilevel judges a collapse by the centroid of the nodes, weighted by area (the mean squared
  /// length of their edges), not all alike: for nodes that are spread unevenly on purpose.
  bool centroid_by_area = false;
  /// What is kept of how the embedding unfolds; nothing by default. It costs about the memory of
  /// its frames and, with Multilevel, the time of the coarsest level.
  HistoryLimits history;
};

/// Work on one level of EmbeddingMethod::Multilevel.
struct LevelReport {
  std::size_t nodes = 0;      ///< of the level's graph
  std::size_t edges = 0;      ///< undirected
  int sweeps = 0;             ///< smoothing sweeps
  int newton_iterations = 0;  ///< steps of Newton's method
  int linear_iterations = 0;  ///< conjugate gradient steps within these
  double residual = 0.0;      ///< mean length of the tangential Laplacian at the end [radius]
};

/// How an embedding was reached.
struct EmbeddingReport {
  /// Of Multilevel: Unfinished without a tolerance; Stagnated also where a barrier keeps the
  /// residual above the tolerance.
  StopReason stop_reason = StopReason::Unfinished;
  int iterations = 0;     ///< steps of the iteration, or of Newton's method
  double residual = 0.0;  ///< mean length of the tangential Laplacian at the embedding [radius]
  /// The same before each step on the graph itself, and at the end (Figures 6 and 7 of the paper);
  /// empty for Multilevel without a tolerance.
  std::vector<double> residuals;
  double centroid_norm = 0.0;  ///< length of the mean direction, in [0, 1]; 1: collapsed
  /// The embedding collapsed: it was replaced by a start that cannot, without iteration.
  bool fallback_start = false;

  // Of EmbeddingMethod::Multilevel alone.

  std::vector<LevelReport> levels;  ///< finest (the graph itself) first
  int starts = 0;                   ///< starts that were tried, on all levels
  int collapsed_starts = 0;         ///< of these, collapsed and rejected
  bool added_barrier = false;       ///< a barrier holds it, which would collapse without
  double energy = 0.0;              ///< that of the weights, without barrier

  /// Whether the tolerance was reached. \return true if it was
  bool converged() const { return stop_reason == StopReason::Converged; }
};

/// An embedding of a graph on the unit sphere.
struct Embedding {
  Positions directions;      ///< 3 x n, unit vectors, column i = node i
  EmbeddingReport report;    ///< how it was reached
  EmbeddingHistory history;  ///< empty unless EmbeddingOptions::history asks for it
};

/// Embeds a graph on the unit sphere so that the tangential Laplacian vanishes:
/// L - (L . u_i) u_i with L = sum_j w_ij (u_j - u_i) (Zwicker and Gotsman 2004, equations 1, 2).
///
/// Iterative (their Figure 3): the points are projected from their centroid. Then, repeatedly:
/// centre so that the sum is 0; project on the sphere; add `damping` times the tangential Laplacian
/// to each point (all at once, Jacobi) and normalise.
///
/// Multilevel: a fixed point of that iteration is a critical point of an energy of the embedding u:
/// with adaptive weights (equation 4) of
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
///    rejected. If all collapse, as on graphs of a few nodes or with wide gaps, a barrier (below)
///    is added. Where it pulls hard, finer levels are tried first, without it.
/// 2. Up: positions are interpolated and smoothed by a few damped sweeps; small levels are solved
///    fully, so that even their smallest parts come to rest.
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
/// pull of that barrier. An embedding that collapses even so is replaced: the rank of a point along
/// the cloud's longest axis gives the height on the sphere (equal areas, Archimedes), the angle
/// around that axis its longitude.
///
/// \param graph   n nodes, connected, with positive edge lengths.
/// \param points  3 x n, finite: the points that the nodes stand for.
/// \param options method, weights, when to end, history
/// \param seed    of the coarse graphs of Multilevel.
/// \param execution threads, progress
/// \return the embedding, the same, bit by bit, for any number of threads.
/// \throw InvalidInput for sizes that disagree, a point that is not finite or options out of range;
/// Cancelled.
/// Cost: O(edges) for each iteration or sweep; with a tolerance about five times that of Multilevel
/// without.
///
/// No guarantees: a graph with shortcuts, holes or pieces that hang by a single node may fold or
/// collapse; limbs that the projection of Iterative folds stay folded. Along a limb of radius r the
/// map shrinks like exp(-s / (r sqrt(p - 1))): tips further than some 40 radii from the widest part
/// come close to the rounding of double, and beyond 50 they coincide.
Embedding embed(const Graph& graph, const Positions& points, const EmbeddingOptions& options = {},
                std::uint32_t seed = 1, const Execution& execution = {});

/// Length of the tangential Laplacian of an embedding at each node [radius of the sphere], computed
/// apart from the solvers, one edge after the other.
///
/// \param graph       as for embed().
/// \param directions  3 x n, unit vectors.
/// \param weights     of the Laplacian.
/// \param exponent    p of the energy of adaptive weights.
/// \return n entries.
/// \throw InvalidInput for sizes that disagree.
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
