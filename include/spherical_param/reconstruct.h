#pragma once

#include "spherical_param/consolidation.h"
#include "spherical_param/embedding.h"
#include "spherical_param/execution.h"
#include "spherical_param/finding.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_optimization.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/openings.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/surface_diagnosis.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// What becomes of the openings of the sampled surface.
enum class SurfaceMode {
  Closed,  ///< they are filled: the mesh is a closed surface, whatever the cloud shows
  Open,    ///< the mesh leaves them open
  Auto,    ///< it leaves those open that are certain
};

/// Parameters of reconstruct(), nested by stage. The defaults need no tuning. The paper's own
/// method is GraphMethod::NearestNeighbors, EmbeddingMethod::Iterative and
/// TriangulationMethod::Qhull, with OptimizationMethod::None. optionTable() lists those
/// that tools, Python and ROS have, with their ranges.
struct Options : Execution {
  /// Whether the points are moved to the surface that they sample, and merged below their noise,
  /// before all else. The mesh is then that of these points, Result::consolidated.
  ConsolidationMode consolidation = ConsolidationMode::None;
  GraphOptions graph;                  ///< how points become neighbours
  EmbeddingOptions embedding;          ///< how the graph is embedded
  TriangulationOptions triangulation;  ///< how the sphere is triangulated
  OptimizationOptions optimization;    ///< of the mesh on the points
  /// Smoothing moves Result::smoothed, never the points that are meshed; the mesh is then optimised
  /// on the smoothed points.
  SmoothingOptions smoothing;

  /// What becomes of openings, which are found by local Delaunay neighbourhoods alone. Whatever
  /// becomes of them, the embedding gives them room, so that the surface beside does not fold.
  SurfaceMode surface = SurfaceMode::Closed;
  /// Openings of up to this number of edges are filled, whatever `surface` says; 0 and up.
  int fill_holes = 0;
  /// The same by the area of the opening [squared unit of the input]; [0, 1e15].
  double fill_holes_area = 0.0;

  std::uint32_t seed = 1;  ///< of all random choices
  /// Fill Result::vertex_residuals and SurfaceDiagnosis::triangle_marks as well.
  bool details = false;
};

/// Time of one stage.
struct StageTime {
  std::string name;  ///< as in Progress::stage
  double seconds;    ///< wall time [s]
};

/// A mesh through all points, the map to the sphere, and their quality. It is closed and of genus
/// 0, or that without the triangles over openings.
struct Result {
  /// 3 x m, indices of vertices, counter-clockwise from outside; m = 2v - 4 of a closed mesh.
  Triangles triangles;
  /// The boundary: closed loops of vertices that are joined by edges of the mesh, the last to the
  /// first, with the surface on the left; the one of most vertices first, each from its lowest
  /// vertex. Empty of a closed mesh.
  std::vector<std::vector<Index>> boundary;
  /// The openings of the surface that were found, open or filled.
  std::vector<Opening> openings;
  Positions sphere;  ///< 3 x v, unit vectors: the embedding of each vertex

  std::vector<Index> vertex_of_input;  ///< n entries: vertex of each input point
  std::vector<Index> input_of_vertex;  ///< v entries: first input point at that position

  /// Pairs of triangles that intersect, ascending. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  /// 3 x v, the points after smoothing; empty without [unit of the input].
  Positions smoothed;
  /// 3 x v, the points after consolidation, before smoothing: those that all else but
  /// `smoothed` is about; empty without [unit of the input].
  Positions consolidated;
  /// How the embedding unfolded, to `sphere`; empty unless EmbeddingOptions::history asks for it.
  EmbeddingHistory history;
  /// v entries: length of the tangential Laplacian of `sphere` [radius]; empty unless
  /// Options::details asks for it.
  std::vector<double> vertex_residuals;

  /// Input points, ascending, that look like outliers; they are vertices even so, one entry for
  /// each. Empty for the graph of nearest neighbours. \see findStrayPoints, without single points
  /// near a surface
  std::vector<Index> outliers;

  MeshTopology topology;       ///< checked on `triangles`
  MeshMeasures measures;       ///< of the mesh on the input's points, or the consolidated ones
  SurfaceDiagnosis diagnosis;  ///< does the cloud look like a closed genus-0 surface?

  // Of the stages; nodes are vertices, lengths in the unit of the input.
  ConsolidationReport consolidation;  ///< all zero without consolidation
  GraphReport graph;                  ///< how the neighbour graph came about
  EmbeddingReport embedding;          ///< how the embedding was reached
  TriangulationReport triangulation;  ///< how the sphere was triangulated
  OptimizationReport optimization;    ///< how the mesh was optimised
  SmoothingReport smoothing;          ///< all zero without smoothing

  std::vector<StageTime> stages;  ///< in the order of the work

  /// Triangles that intersect another one, on the smoothed points if there are some.
  std::size_t intersecting_triangles = 0;
  std::string verdict;            ///< a headline, e.g. "A sound mesh with 2 openings."
  std::vector<Finding> findings;  ///< what to know, and what to do; empty if all is well

  /// Number of distinct points. \return v
  std::size_t vertexCount() const { return input_of_vertex.size(); }
  /// Where the vertices were moved. \return `smoothed`, or without smoothing `consolidated`: empty
  /// if they are the input's points
  const Positions& moved() const { return smoothed.cols() > 0 ? smoothed : consolidated; }
  /// Whether the mesh is closed. \return true if it has no boundary
  bool isClosed() const { return boundary.empty(); }
  /// Whether the mesh can be worked with. \return true if at most 1 % of its triangles intersect
  bool isUsable() const {
    return 100 * intersecting_triangles <= static_cast<std::size_t>(triangles.cols());
  }
  /// Whether the mesh is folded. Smoothed points on which no triangles intersect unfold one that
  /// noise folds. \return true if it leaves the graph in too many places
  bool isFolded() const {
    return diagnosis.isFolded() && (smoothed.cols() == 0 || intersecting_triangles > 0);
  }
  /// Whether the mesh encloses something: else volume, centroid and inertia of `measures` are
  /// meaningless. \return true if it is closed, usable and not folded
  bool hasVolume() const { return isClosed() && isUsable() && !isFolded(); }
  /// Points that repeat an earlier one. \return n - v, without those that consolidation merged
  std::size_t duplicates() const {
    return vertex_of_input.size() - input_of_vertex.size() - consolidation.merged;
  }
};

/// Checks the ranges of all options, as reconstruct() does first: for callers who have long work to
/// do before.
///
/// \param options all of them.
/// \throw InvalidInput with the option, its value and the remedy.
void checkOptions(const Options& options);

/// Meshes a point cloud: nearest neighbours -> neighbour graph -> embedding on the sphere ->
/// triangulation there -> optimisation on the points -> diagnosis.
///
/// \param points 3 x n, finite, at least 4 distinct points that are not all in one plane, no
///               coordinate beyond 1e100. The topology is sound whatever their differences; below
///               1e-90 of the cloud's extent self-intersections are no longer found exactly, and
///               the geometry is arbitrary far sooner: see doc/numbers.md.
/// \param options the defaults need no tuning.
/// \return the mesh. Triangles index vertices: v = 0 ... input_of_vertex.size() - 1.
/// \throw InvalidInput for bad points or options; ComputeError; Cancelled.
///
/// Guaranteed: the mesh is closed, manifold, consistently oriented, of genus 0 and in one piece,
/// and every distinct point, or consolidated one, is a vertex. The same input and options give the
/// same result, bit by bit, whatever the number of threads. Reentrant: no state is shared between
/// calls.
///
/// Not guaranteed: that the mesh is free of self-intersections or near the sampled surface;
/// `verdict`, `findings` and `diagnosis` say how far to trust it.
/// Cost: O(n log n), typically; with the iterative embedding iterations * O(n k) more. Below 2 KB
/// of memory a point; 3 KB for the multilevel embedding with a tolerance on a graph of 25
/// neighbours.
Result reconstruct(const Positions& points, const Options& options = {});

/// The same with neighbours that the caller has found.
///
/// \param points  as above.
/// \param lists   n neighbour lists, e.g. the neighborsToSearch() nearest of each point; unsorted,
///                with or without the point itself. Those of points that repeat an earlier point
///                may be empty.
/// \param options as above.
///                With consolidation they are not used: the points have moved.
/// \param search  asked for longer lists of some points by local Delaunay neighbourhoods; never of
///                points that repeat an earlier one. Called from the calling thread. May be empty:
///                the graph is then made of the lists alone.
/// \return the mesh, as above.
/// \throw as above, and InvalidInput for bad lists; what `search` throws is passed on.
Result reconstruct(const Positions& points, const NeighborLists& lists, const Options& options = {},
                   const NeighborSearch& search = {});

/// @}

}  // namespace spherical_param
