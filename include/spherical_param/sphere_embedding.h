#pragma once

#include "spherical_param/types.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace spherical_param {

/// Weights of the Laplacian (Zwicker and Gotsman 2004, section 3, equations 2 to 4), normalised so
/// that they sum to 1 at each node.
enum class EdgeWeights {
  Uniform,        ///< w_ij = 1
  InverseLength,  ///< w_ij = 1 / |p_i - p_j|
  Adaptive,       ///< w_ij = |u_i - u_j| / |p_i - p_j|, recomputed in each iteration (equation 4)
};

/// Why the iteration ended.
enum class StopReason {
  Converged,       ///< the residual is at most the tolerance
  IterationLimit,  ///< `max_iterations` steps were made
  Stagnated,       ///< the residual no longer changes
  Collapsed,       ///< nearly all points are at one place of the sphere: not an embedding
};

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
};

/// An embedding of a graph on the unit sphere and how it was reached.
struct Embedding {
  Positions directions;  ///< 3 x n, unit vectors, column i = node i
  StopReason stop_reason = StopReason::IterationLimit;
  int iterations = 0;     ///< steps made
  double residual = 0.0;  ///< mean length of the tangential Laplacian at `directions` [radius]
  /// Mean length of the tangential Laplacian before each step, and of the last state:
  /// iterations + 1 entries (Figures 6 and 7 of the paper).
  std::vector<double> residuals;
  double centroid_norm = 0.0;  ///< length of the mean of `directions`, in [0, 1]; 1: collapsed

  bool converged() const { return stop_reason == StopReason::Converged; }
};

/// Projects points from their centroid onto the unit sphere: the start of the iteration in Figure 3
/// of the paper. A point at the centroid itself is given a fixed direction.
///
/// \param points 3 x n, finite.
Positions projectFromCentroid(const Positions& points);

/// Directions that are never collapsed, whatever the points: the rank of a point along the cloud's
/// longest axis gives the height on the sphere (equal areas, Archimedes), the angle around that
/// axis its longitude. The start of last resort.
///
/// \param points 3 x n, finite.
Positions projectByRank(const Positions& points);

/// Embeds a graph on the unit sphere by the iteration of Zwicker and Gotsman 2004, Figure 3:
/// centre so that the sum is 0; project on the sphere; add lambda times the tangential Laplacian
/// to each point (all at once, Jacobi) and normalise; repeat.
///
/// The tangential Laplacian is L - (L . u_i) u_i with L = sum_j w_ij (u_j - u_i) (equations 1, 2).
///
/// \param graph      connected, with positive edge lengths.
/// \param start      3 x n, finite: the points themselves (u = p) or any other start.
/// \return the last state. The result is bit-identical for any number of threads.
/// \throw InvalidInput for sizes that disagree or options out of range; Cancelled.
/// Cost: O(edges) per iteration.
///
/// No guarantees: limbs that the projection folds stay folded; the residual need not vanish; the
/// uniform weights may collapse slowly (reported as StopReason::Collapsed).
Embedding embedOnSphere(const Graph& graph, const Positions& start,
                        const EmbeddingOptions& options = {});

/// Mean length of the tangential Laplacian of an embedding [radius of the sphere], computed apart
/// from the solver, one edge after the other.
///
/// \param graph       as for embedOnSphere().
/// \param directions  3 x n, unit vectors.
double meanTangentialLaplacian(const Graph& graph, const Positions& directions,
                               EdgeWeights weights);

}  // namespace spherical_param
