#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <optional>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// Which points are left out first because they belong to no surface.
enum class OutlierMode {
  None,  ///< no points; a finding reports likely outliers
  Auto,  ///< stray points: isolated points, small clusters, nets, isolated points near a surface
  /// points too far from the average of their neighbours (Zwicker and Gotsman 2004, section 4.2).
  Deviation,
};

/// Which parts of a cloud are meshed. A part is a set of points that neighbours connect.
enum class PartsMode {
  All,      ///< all together, as one surface
  Largest,  ///< the part with the most points
  Each,     ///< each part as a mesh of its own
};

/// Whether points are consolidated before meshing.
enum class ConsolidationMode {
  None,  ///< the mesh goes through the given points
  Auto,  ///< points are moved to the sampled surface and merged within their noise
};

/// How points become neighbours.
enum class GraphMethod {
  NearestNeighbors,  ///< nearest-neighbour graph (Zwicker and Gotsman 2004, section 3)
  LocalDelaunay,     ///< tangent Delaunay graph (future work in their section 6)
};

/// How a graph is embedded on the sphere.
enum class EmbeddingMethod {
  Iterative,   ///< the iteration of Zwicker and Gotsman 2004, Figure 3
  Multilevel,  ///< from coarse to fine graphs; unfolds limbs
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
  /// (2, 16]. 3 gives the weights of the paper; the iteration supports only 3.
  double exponent = 3.0;
  /// Fraction of the tangential Laplacian by which iteration and smoothing sweeps move each point;
  /// (0, 1].
  double damping = 0.5;
  /// Mean length of the tangential Laplacian at which the embedding counts as converged [radius of
  /// the sphere]; [0, 1]. Unset: 1e-8 for the iteration; Multilevel then ends with its sweeps.
  std::optional<double> tolerance;
  /// Maximum number of steps of the iteration, as in Table 1 of the paper; >= 0. 0: the embedding
  /// is the projection of the points from their centroid.
  int max_iterations = 1600;
  /// Iterations over which stagnation is judged; 0 or 1: never; >= 0.
  int stagnation_window = 100;
  /// Number of starts of Multilevel on the coarsest level; the start of least energy is kept;
  /// [1, 100].
  int starts = 2;
  /// Maximum number of nodes whose paths are recorded to show how the embedding unfolds; 0: none;
  /// [0, 2^24]. Costs the memory of the states and, with Multilevel, the time of the coarsest
  /// level.
  Index history_vertices = 0;
  /// Maximum number of states of these paths; [2, 10000]. Surplus states between the first and the
  /// last are dropped.
  int history_frames = 40;
};

/// How the points on the sphere are triangulated.
enum class TriangulationMethod {
  Qhull,        ///< convex hull by qhull (Zwicker and Gotsman 2004, section 3), completed
  Incremental,  ///< incremental Delaunay triangulation with exact predicates
};

/// How a mesh on fixed points is optimised.
enum class OptimizationMethod {
  None,   ///< not at all
  Flips,  ///< edge flips only
  Full,   ///< flips, relocation of vertices, ruin and recreate
};

/// Whether openings of the sampled surface are filled.
enum class SurfaceMode {
  Closed,  ///< all are filled: the mesh is always closed
  Open,    ///< all stay open
  Auto,    ///< certain openings stay open, others are filled
};

/// Parameters of reconstruct(). The defaults need no tuning. The paper's own method is
/// GraphMethod::NearestNeighbors, EmbeddingMethod::Iterative, TriangulationMethod::Qhull and
/// OptimizationMethod::None. optionTable() lists the options of tools, Python and ROS with their
/// ranges.
struct Options : Execution {
  OutlierMode outliers = OutlierMode::None;  ///< which points are left out first
  /// OutlierMode::Deviation: outliers deviate by more than the mean and this number of standard
  /// deviations; [0, 1000].
  double outlier_sigma = 4.0;
  PartsMode parts = PartsMode::All;  ///< which parts are meshed
  /// Minimum number of distinct points of a part; >= 4. Smaller parts are left out. No effect with
  /// PartsMode::All.
  int min_points = 50;
  /// Whether points are consolidated before meshing. The mesh then goes through
  /// Surface::consolidated.
  ConsolidationMode consolidation = ConsolidationMode::None;
  GraphMethod graph = GraphMethod::LocalDelaunay;  ///< how points become neighbours
  /// Nearest neighbours of each point; >= 3 (k >= n: n - 1 are used). Unset: 25 for the
  /// nearest-neighbour graph, as in the paper; 12 for the tangent Delaunay graph, which searches
  /// for up to 32 where needed.
  std::optional<int> k;
  EmbeddingOptions embedding;  ///< how the graph is embedded
  TriangulationMethod triangulation = TriangulationMethod::Incremental;  ///< of the sphere
  OptimizationMethod optimization = OptimizationMethod::Full;  ///< of the mesh on the points
  /// Strength of smoothing, in steps of the paper's section 4.2; [0, 10000], 0: none. The result is
  /// Surface::smoothed; the input points stay. The mesh is then optimised on the smoothed points.
  int smoothing = 0;

  /// Whether openings are filled. Only the tangent Delaunay graph finds them. The embedding leaves
  /// room for them in any case, so that the surface beside them does not fold.
  SurfaceMode surface = SurfaceMode::Closed;
  /// Openings of up to this number of edges are filled in any case; >= 0.
  int fill_holes = 0;
  /// Openings of up to this area are filled in any case [squared unit of the input]; [0, 1e15].
  double fill_holes_area = 0.0;

  std::uint32_t seed = 1;  ///< of all random choices
  /// Fill Surface::vertex_residuals and SurfaceDiagnosis::triangle_marks.
  bool details = false;
};

/// Number of nearest neighbours of each point to search for first.
///
/// \param options graph, k
/// \return Options::k or its default; >= 3.
int neighborsToSearch(const Options& options);

/// Checks the ranges of all options. reconstruct() does so too; callers may check before long work.
///
/// \param options to check.
/// \throw InvalidInput with the option, its value and the remedy.
void checkOptions(const Options& options);

/// @}

}  // namespace spherical_param
