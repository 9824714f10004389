#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <optional>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// Which points are left out before all else, as they belong to no surface.
enum class OutlierMode {
  None,  ///< none; those that look like outliers are a finding
  Auto,  ///< stray points: single ones, small clusters, nets of them, single ones near a surface
  /// Points too far from the average of their neighbours (Zwicker and Gotsman 2004, section 4.2).
  Deviation,
};

/// Which parts of a cloud are meshed. A part is a surface of its own: points that neighbours join.
enum class PartsMode {
  All,      ///< all together, as one surface
  Largest,  ///< that of most points
  Each,     ///< each by itself
};

/// Whether points are consolidated before they are meshed.
enum class ConsolidationMode {
  None,  ///< the mesh goes through the points as they are
  Auto,  ///< they are moved to the surface that they sample, and merged below their noise
};

/// How points become neighbours.
enum class GraphMethod {
  NearestNeighbors,  ///< k nearest neighbours (Zwicker and Gotsman 2004, section 3)
  LocalDelaunay,     ///< local Delaunay neighbourhoods (the future work of their section 6)
};

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

/// Parameters of the embedding.
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
  /// Maximum number of steps of the iteration, as in Table 1 of the paper; >= 0. With 0 the
  /// embedding is the projection of the points from their centroid.
  int max_iterations = 1600;
  /// Iterations over which stagnation is judged; 0 or 1: never; >= 0.
  int stagnation_window = 100;
  /// Starts of Multilevel on the coarsest level, of which the one of least energy is kept; 1 to
  /// 100.
  int starts = 2;
  /// Maximum number of nodes whose paths are kept, to show how the embedding unfolds; 0: none;
  /// [0, 2^24]. It costs about the memory of the states and, with Multilevel, the time of the
  /// coarsest level.
  Index history_vertices = 0;
  /// Maximum number of states of these paths; [2, 10000]. Of more, some between the first and the
  /// last are left out.
  int history_frames = 40;
};

/// How the points on the sphere are triangulated.
enum class TriangulationMethod {
  Qhull,        ///< convex hull by qhull (Zwicker and Gotsman 2004, section 3), completed
  Incremental,  ///< incremental Delaunay triangulation with exact predicates
};

/// How far a mesh on fixed points is optimised.
enum class OptimizationMethod {
  None,   ///< not at all
  Flips,  ///< edge flips alone
  Full,   ///< flips, vertices moved to other places of the mesh, parts taken out and put back
};

/// What becomes of the openings of the sampled surface.
enum class SurfaceMode {
  Closed,  ///< they are filled: the mesh is a closed surface, whatever the cloud shows
  Open,    ///< the mesh leaves them open
  Auto,    ///< it leaves those open that are certain
};

/// Parameters of reconstruct(). The defaults need no tuning. The paper's own method is
/// GraphMethod::NearestNeighbors, EmbeddingMethod::Iterative and TriangulationMethod::Qhull, with
/// OptimizationMethod::None. optionTable() lists those that tools, Python and ROS have, with their
/// ranges.
struct Options : Execution {
  OutlierMode outliers = OutlierMode::None;  ///< which points are left out first
  /// With OutlierMode::Deviation, outliers are farther off than the mean by this number of standard
  /// deviations; [0, 1000].
  double outlier_sigma = 4.0;
  PartsMode parts = PartsMode::All;  ///< which parts are meshed
  /// Minimum number of distinct points of a part, unless all parts are meshed together; smaller
  /// ones are left out; 4 and up.
  int min_points = 50;
  /// Whether the points of a part are moved to the surface that they sample, and merged below their
  /// noise, before it is meshed. The mesh is then that of Surface::consolidated.
  ConsolidationMode consolidation = ConsolidationMode::None;
  GraphMethod graph = GraphMethod::LocalDelaunay;  ///< how points become neighbours
  /// Nearest neighbours of each point; 3 and up (k >= n: n - 1 are used). Unset: 25, the paper's,
  /// for the graph of nearest neighbours; 12 for local Delaunay neighbourhoods, which search for
  /// more where they need them, up to 32 in all.
  std::optional<int> k;
  EmbeddingOptions embedding;  ///< how the graph is embedded
  TriangulationMethod triangulation = TriangulationMethod::Incremental;  ///< of the sphere
  OptimizationMethod optimization = OptimizationMethod::Full;  ///< of the mesh on the points
  /// Strength of smoothing, in steps of the paper's section 4.2; [0, 10000], 0: none. It moves
  /// Surface::smoothed, never the points that are meshed; the mesh is then optimised on the
  /// smoothed points.
  int smoothing = 0;

  /// What becomes of openings, which are found by local Delaunay neighbourhoods alone. In any case
  /// the embedding gives them room, so that the surface beside does not fold.
  SurfaceMode surface = SurfaceMode::Closed;
  /// Openings of up to this number of edges are filled with any `surface`; 0 and up.
  int fill_holes = 0;
  /// The same by the area of the opening [squared unit of the input]; [0, 1e15].
  double fill_holes_area = 0.0;

  std::uint32_t seed = 1;  ///< of all random choices
  /// Fill Surface::vertex_residuals and SurfaceDiagnosis::triangle_marks as well.
  bool details = false;
};

/// The nearest neighbours of each point to search for at first.
///
/// \param options of the graph.
/// \return Options::k or its default; 3 and up.
int neighborsToSearch(const Options& options);

/// Checks the ranges of all options, as reconstruct() does first: for callers who have long work to
/// do before.
///
/// \param options all of them.
/// \throw InvalidInput with the option, its value and the remedy.
void checkOptions(const Options& options);

/// @}

}  // namespace spherical_param
