#pragma once

#include "spherical_param/embedding_history.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_embedding.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/surface_diagnosis.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// State of the work, as told to Options::progress.
struct Progress {
  /// "neighbors", "graph", "embedding", "triangulation", "optimization", "smoothing" or "check";
  /// all but the last once more for each further attempt
  const char* stage;
  /// Share of the stage that is done, in [0, 1], about in proportion to its time; never falls, and
  /// is 1 at the stage's end alone.
  double fraction;
  int iteration;    ///< iteration of the embedding's current level, else 0
  double residual;  ///< residual of the embedding, else 0
};

/// Parameters of reconstruct(). The defaults need no tuning. The paper's own method is
/// GraphMethod::NearestNeighbors, EmbeddingMethod::Iterative and TriangulationMethod::Qhull, with
/// OptimizationMethod::None.
struct Options {
  GraphMethod graph = GraphMethod::LocalDelaunay;               ///< how points become neighbours
  EmbeddingMethod solver = EmbeddingMethod::Multilevel;         ///< how the graph is embedded
  TriangulationMethod hull = TriangulationMethod::Incremental;  ///< how the sphere is triangulated

  /// Neighbours of each point; 3 and up (k >= n: n - 1 are used). Unset: 25 (the paper's) for the
  /// graph of nearest neighbours; 12 for local Delaunay neighbourhoods, which ask for more where
  /// they need them, up to 32 in all.
  std::optional<int> k;
  EdgeWeights weights = EdgeWeights::Adaptive;  ///< weights of the Laplacian
  /// p of the energy that adaptive weights minimise, sum |u_i - u_j|^p / (p |p_i - p_j|^(p - 2));
  /// (2, 16]. 3 are the weights of the paper, and all that the iterative solver knows.
  double exponent = 3.0;
  double lambda = 0.5;  ///< damping of iteration and smoothing sweeps; (0, 1]
  /// Mean tangential Laplacian at which the embedding counts as converged [radius]; >= 0. Unset:
  /// 1e-8 for the iterative solver; the multilevel solver then ends with its smoothing sweeps.
  std::optional<double> tolerance;

  int max_iterations = 1600;  ///< of the iterative solver, at most; >= 0
  int stagnation_window =
      100;                 ///< its iterations over which stagnation is judged; 0: never; or >= 2
  int starts = 2;          ///< of the multilevel solver's coarsest level; 1 to 100
  std::uint32_t seed = 1;  ///< of all that is random: the solver's starts, parts taken out

  OptimizationMethod optimization = OptimizationMethod::Full;  ///< of the mesh on the points
  /// Whole runs, at most, while the mesh intersects itself although the cloud looks like a closed
  /// surface: with other graphs, then other seeds, then the radial start. The best counts. 1 to
  /// 100.
  int attempts = 4;
  /// Steps of smoothing, 0: none; [0, 10000]. They move Result::smoothed, never the points of the
  /// mesh; the mesh is then optimised on the smoothed points.
  int smoothing_steps = 0;

  /// What is kept of how the embedding unfolded, in Result::history; nothing, by default. It costs
  /// about the memory of its frames, and with the multilevel solver the time of its coarsest level.
  HistoryLimits history;
  /// Fill Result::vertex_residuals and SurfaceDiagnosis::triangle_marks as well.
  bool details = false;

  int threads = 0;  ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Told how far the work is, every second or two if it is long; returning false ends it with
  /// Cancelled. May be empty. Called from the calling thread only. The paper's own stages, and a
  /// tolerance for the multilevel solver, have longer silences.
  std::function<bool(const Progress&)> progress;
};

/// Time of one stage of the pipeline.
struct StageTime {
  std::string name;  ///< as in Progress::stage
  double seconds;    ///< wall time [s]
};

/// Size of the neighbour graph and what it took to connect it.
struct GraphReport {
  std::size_t edges = 0;        ///< undirected edges, bridges included
  Index components = 0;         ///< connected components before bridging
  std::vector<Bridge> bridges;  ///< added edges; nodes are vertices of the Result
  /// Vertices without a trustworthy tangent plane, ascending: the graph there is one of nearest
  /// neighbours. This and all below of GraphMethod::LocalDelaunay alone.
  std::vector<Index> without_tangent_plane;
  Index searched_again = 0;  ///< points for which more neighbours were asked
  Index uncertified = 0;     ///< points whose cell is not certified even so
  Index weak = 0;            ///< points that too few neighbours agreed with, repaired
};

/// How the embedding ended.
struct EmbeddingReport {
  StopReason stop_reason = StopReason::IterationLimit;  ///< why it ended
  int iterations = 0;             ///< steps made; of Newton's method for the multilevel solver
  double residual = 0.0;          ///< mean tangential Laplacian of Result::sphere [radius]
  std::vector<double> residuals;  ///< of the iteration, before each step and at its end [radius]
  double centroid_norm = 0.0;     ///< length of the mean direction of Result::sphere; 1: collapsed
  /// The iteration collapsed: Result::sphere is a start that did not, without iteration.
  bool fallback_start = false;

  // Of EmbeddingMethod::Multilevel alone.

  std::vector<LevelReport> levels;  ///< finest first
  int starts = 0;                   ///< starts of the coarsest level that were tried
  int collapsed_starts = 0;         ///< of these, collapsed and rejected
  bool added_barrier = false;       ///< all starts collapsed: a barrier against it was added
  double energy = 0.0;              ///< that of the weights, at Result::sphere
};

/// How the triangulation came about.
struct TriangulationReport {
  Index hull_vertices = 0;     ///< points that the triangulation held by itself as vertices
  Index reinserted = 0;        ///< points that it left out, put back
  Index coincident = 0;        ///< of these, at exactly the position of another point
  bool hull_rejected = false;  ///< the hull could not be used; all points were inserted one by one
};

/// How the mesh was optimised. \see MeshOptimization
struct OptimizationReport {
  std::vector<OptimizationPhase> phases;  ///< of the attempt that counts
  double energy = 0.0;                    ///< equation (1) of optimizeMesh() [unit of the input]
  double rough = 0.0;  ///< share of rough vertices after the first flips, in [0, 1]
  /// Steps of smoothing of the positions that the mesh was optimised on because the cloud is noisy;
  /// 0: it is not.
  int noise_steps = 0;
  double alignment = 0.0;   ///< how far the sampling follows the curvature, in [-1, 1]
  double unevenness = 0.0;  ///< relative deviation of the distances of a point's neighbours
};

/// One whole run, of Options::attempts.
struct AttemptReport {
  std::string description;             ///< what is different from the first
  std::size_t self_intersections = 0;  ///< pairs of triangles, on the points or the smoothed ones
  double energy = 0.0;                 ///< equation (1) of optimizeMesh() [unit of the input]
  double seconds = 0.0;                ///< wall time after the graph [s]
  bool chosen = false;                 ///< the least (self_intersections, energy)
};

/// The smoothed surface. \see Smoothing
struct SmoothingReport {
  double max_displacement = 0.0;       ///< of a point [unit of the input]
  double mean_displacement = 0.0;      ///< [unit of the input]
  double rms_displacement = 0.0;       ///< [unit of the input]
  double volume_before = 0.0;          ///< [cubed unit of the input]
  double volume_after = 0.0;           ///< [cubed unit of the input]
  std::size_t self_intersections = 0;  ///< pairs of triangles, on the smoothed points
};

/// A closed genus-0 mesh through all points, the map to the sphere, and their quality.
struct Result {
  Triangles triangles;  ///< 3 x (2v - 4), indices of vertices, counter-clockwise from outside
  Positions sphere;     ///< 3 x v, unit vectors: the embedding of each vertex

  std::vector<Index> vertex_of_input;  ///< n entries: vertex of each input point
  std::vector<Index> input_of_vertex;  ///< v entries: first input point at that position
  std::size_t duplicates = 0;          ///< n - v: points merged into an earlier one

  /// Pairs of triangles that intersect, ascending. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  /// 3 x v, the points after Options::smoothing_steps; empty without [unit of the input].
  Positions smoothed;
  /// How the embedding of the attempt that counts unfolded, to Result::sphere; empty unless
  /// Options::history asks for it.
  EmbeddingHistory history;
  /// v entries: length of the tangential Laplacian of Result::sphere [radius]; empty unless
  /// Options::details asks for it.
  std::vector<double> vertex_residuals;

  MeshTopology topology;       ///< checked on `triangles`
  MeshMeasures measures;       ///< of the mesh on the input's points
  SurfaceDiagnosis diagnosis;  ///< does the cloud look like a closed genus-0 surface?
  double volume = 0.0;         ///< enclosed signed volume [cubed unit of the input]
  double area = 0.0;           ///< [squared unit of the input]
  /// Share of the mesh's edges that join points more than two steps apart in the neighbour graph,
  /// in [0, 1]. Large where the embedding is folded, or the cloud is no closed genus-0 surface.
  double edges_outside_graph = 0.0;

  GraphReport graph;                    ///< how the neighbour graph came about
  EmbeddingReport embedding;            ///< how the embedding ended
  TriangulationReport triangulation;    ///< how the sphere was triangulated
  OptimizationReport optimization;      ///< how the mesh was optimised
  SmoothingReport smoothing;            ///< all zero without smoothing
  std::vector<AttemptReport> attempts;  ///< in the order of the work; at least one
  std::vector<StageTime> stages;        ///< in the order of the work, of all attempts together
  std::vector<std::string> warnings;    ///< one sentence each; empty if nothing is to be said

  /// Number of distinct points. \return v
  std::size_t vertexCount() const { return input_of_vertex.size(); }
};

/// The neighbours of each point that a caller should search for: Options::k or its default.
///
/// \param options of which Options::k and Options::graph count.
/// \return the number, 3 and up.
int neighborsToSearch(const Options& options);

/// Checks the ranges of all options, as reconstruct() does first: for callers who have long work to
/// do before, such as a neighbour search.
///
/// \param options all of them.
/// \throw InvalidInput with the option, its value and the remedy.
void checkOptions(const Options& options);

/// Meshes a point cloud: neighbour graph -> embedding on the sphere -> triangulation there ->
/// optimisation on the points -> check.
///
/// \param points 3 x n, finite, at least 4 distinct points that are not all in one plane, no
///               coordinate beyond 1e100. Any differences keep the topology sound; below 1e-90 of
///               the cloud's extent what is told of self-intersections is no longer exact, and the
///               geometry is arbitrary far sooner: see doc/numbers.md.
/// \param lists  n neighbour lists, e.g. the k nearest of each point; unsorted, with or without the
///               point itself. Those of points that repeat an earlier point may be empty.
/// \param options the defaults need no tuning.
/// \param search asked for longer lists of some points, by local Delaunay neighbourhoods; of points
///               that repeat an earlier one it is never asked. Called from the calling thread.
///               May be empty: the lists are then all there is.
/// \return the mesh. Triangles index vertices: v = 0 ... input_of_vertex.size() - 1.
/// \throw InvalidInput for bad points, lists or options; ComputeError; Cancelled.
///
/// Guaranteed: the mesh is closed, manifold, consistently oriented, of genus 0 and in one piece,
/// and every distinct point is a vertex. The same input and options give the same result, bit by
/// bit, whatever the number of threads. Reentrant: no state is shared between calls.
///
/// Not guaranteed: that the mesh is free of self-intersections or near the sampled surface;
/// `self_intersections`, `diagnosis` and `warnings` tell how much to trust it.
/// Cost: O(n log n), typically; with the iterative solver iterations * O(n k) more. Below 2 KB of
/// memory a point; 3 KB for the multilevel solver with a tolerance on a graph of 25 neighbours.
Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options = {},
                   const NeighborSearch& search = {});

/// Makes a search among the points that it is given: the distinct ones, in an order in which those
/// that are near in space are mostly near in memory.
///
/// \param points 3 x v, scaled by a power of two to an extent of about 1; kept until the search is
///               gone.
/// \param input_of_point v entries: the first input point at each of them; kept as well.
/// \return a search whose points and answers are numbers of these points, 0 ... v - 1.
using NeighborSearchFactory = std::function<NeighborSearch(
    const Positions& points, const std::vector<Index>& input_of_point)>;

/// Share of the stage "neighbors" that is done when the search is first asked: the points are in
/// order, and a search made. Whoever tells of the search's own progress does so from there to 1.
inline constexpr double kShareBeforeSearch = 0.2;

/// The same with a search instead of lists: faster, since the points are put in order before it.
///
/// \param points      as above.
/// \param make_search called at the beginning, and again for further attempts. The search is asked
///                    for the neighborsToSearch() nearest of all points, then for more of some.
///                    Both are called from the calling thread; what they throw is passed on.
/// \param options     the defaults need no tuning.
/// \return the mesh, as above.
Result reconstruct(const Positions& points, const NeighborSearchFactory& make_search,
                   const Options& options = {});

/// @}

}  // namespace spherical_param
