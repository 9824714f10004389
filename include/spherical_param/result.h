#pragma once

#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/types.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// Time of one stage.
struct StageTime {
  std::string name;  ///< as in Progress::stage
  double seconds;    ///< wall time [s]
};

/// What a user should know of a mesh, and what to do about it.
struct Finding {
  std::string text;  ///< a clause, e.g. "2 separate parts (395 and 5,633 points)"
  /// The option that deals with it, a name of optionTable(); empty if there is none.
  std::string option;
  std::string value;      ///< of that option, e.g. "largest"
  bool is_fault = false;  ///< a self-intersection, fold, filled opening, cut handle or joined part
  /// Another finding of the same surface names the option that deals with this fault as well.
  bool is_consequence = false;
};

/// Whether one of them is a fault.
///
/// \param findings of a result.
/// \return false if there are none.
inline bool hasFault(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.is_fault; });
}

/// An opening of the sampled surface: a wide face of its neighbour graph.
struct Opening {
  /// Vertices around it, in order; a vertex that the face passes twice is listed twice.
  std::vector<Index> loop;
  double boundary_length = 0.0;  ///< of the loop [unit of the input]
  double area = 0.0;             ///< of a surface over it: length of its vector area [unit squared]
  double spacing = 0.0;          ///< mean distance of the points at the loop [unit of the input]
  /// min(4 area / boundary_length, boundary_length / pi), the diameter of a disc [unit of the
  /// input].
  double width = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the loop
  /// How certain it is, in [0, 1]: 0 for a face of the minimum width, 3 spacings; 1 from 9 spacings
  /// on.
  double certainty = 0.0;
  /// The loop lies in a plane: it may be a flat face of the surface without points inside.
  bool is_flat = false;
  bool is_filled = false;        ///< the mesh has triangles there
  std::vector<Index> triangles;  ///< of the mesh over a filled opening; each lies over one only

  /// Whether it is an opening of the surface for sure, not a gap in the sampling or a flat face:
  /// SurfaceMode::Auto leaves these open, and to fill one is a fault. \return true if it is
  bool isCertain() const { return certainty >= 1.0 && !is_flat; }
};

/// What a cloud shows, judged by its mesh and its neighbour graph.
enum class SurfaceKind {
  ClosedGenus0,  ///< nothing speaks against a closed surface without handles, in one piece
  Open,          ///< the surface has openings, which the mesh fills or leaves open
  Handles,       ///< the surface has handles, which the mesh cuts
  SeveralParts,  ///< there are several surfaces, which the mesh joins
  Unclear,       ///< the mesh leaves the graph in too many places: noise, or the mesh is folded
};

/// Bits of SurfaceDiagnosis::triangle_marks.
namespace triangle_mark {
inline constexpr std::uint8_t self_intersection = 1;  ///< intersects another
inline constexpr std::uint8_t filled_hole = 2;        ///< over a certain opening that is filled
inline constexpr std::uint8_t handle = 4;             ///< at the ends of torn edges of a handle
inline constexpr std::uint8_t part_bridge = 8;        ///< at the ends of bridges between parts
inline constexpr std::uint8_t outside_graph = 16;     ///< at an edge outside the graph's 2-ring
}  // namespace triangle_mark

/// Neighbours in the graph, along the surface, that the mesh tears apart.
struct Handle {
  std::size_t edges = 0;  ///< of the graph that are torn
  double size = 0.0;      ///< diagonal of the box around them [unit of the input]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of their ends
  std::vector<Index> vertices;                       ///< their ends, ascending
};

/// Two parts of the cloud with a gap between them.
struct PartBridge {
  std::size_t points = 0;        ///< of the smaller part
  std::size_t other_points = 0;  ///< of the larger part
  double gap = 0.0;              ///< least distance that a bridge spans [unit of the input]
  double spacing = 0.0;          ///< distance of the points at its ends [unit of the input]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the ends of all its bridges
  std::vector<Index> vertices;                       ///< the ends, ascending
};

/// What speaks against a closed genus-0 surface, and where.
struct SurfaceDiagnosis {
  SurfaceKind kind = SurfaceKind::ClosedGenus0;  ///< the gravest of what was found
  std::vector<Handle> handles;                   ///< by falling number of edges
  std::vector<PartBridge> bridges;               ///< by falling number of points
  bool is_one_sided = false;                     ///< found with openings alone: the mesh tears it
  /// Fraction of the mesh's edges that join points more than two steps apart in the graph, in [0,
  /// 1].
  double edges_outside_graph = 0.0;
  /// Handles of the surface, counted by the cycles of the graph whatever the mesh does to them;
  /// none where that was not needed, as neighbours are nowhere torn apart, or unknown.
  std::optional<int> genus;
  /// For each triangle, the bits of all findings, listed or not; empty unless
  /// Options::details asks for it.
  std::vector<std::uint8_t> triangle_marks;

  /// Whether nothing speaks against a closed genus-0 surface. \return true if nothing does
  bool looksClosedGenus0() const { return kind == SurfaceKind::ClosedGenus0; }
  /// Whether the mesh leaves the graph in too many places to show the surface, whatever that is.
  /// \return true if more than a tenth of its edges do
  bool isFolded() const;
};

/// What consolidation found and did.
struct ConsolidationReport {
  double noise = 0.0;      ///< median distance of the points from the surface [unit of the input]
  std::size_t merged = 0;  ///< points that became one with others, without exact duplicates
  double max_displacement = 0.0;  ///< of a point, to where it or what it is merged into ends [unit]
  double mean_displacement = 0.0;  ///< over the points [unit of the input]
  double rms_displacement = 0.0;   ///< over the points [unit of the input]
};

/// Why the work on an embedding ended.
enum class StopReason {
  Converged,       ///< the residual is at most the tolerance
  IterationLimit,  ///< `max_iterations` steps were made
  Stagnated,       ///< the residual no longer changes, or rounding allows no further step
  Collapsed,       ///< nearly all points are at one place of the sphere: not an embedding
  Unfinished,      ///< convergence was not asked for: the last smoothing sweep was made
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
  bool added_barrier = false;       ///< a barrier holds it, which would collapse without

  /// Whether the tolerance was reached. \return true if it was
  bool converged() const { return stop_reason == StopReason::Converged; }
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

/// How an embedding unfolded, for some of its vertices.
struct EmbeddingHistory {
  std::vector<Index> vertices;       ///< whose paths these are
  std::vector<HistoryFrame> frames;  ///< in the order of the work; the last is the embedding
};

/// How far a smoothed surface is from the one given.
struct SmoothingReport {
  double max_displacement = 0.0;       ///< of a point [unit of the input]
  double mean_displacement = 0.0;      ///< over the points of triangles [unit of the input]
  double rms_displacement = 0.0;       ///< over the points of triangles [unit of the input]
  double volume_before = 0.0;          ///< signed volume enclosed [cubed unit of the input]
  double volume_after = 0.0;           ///< signed volume enclosed [cubed unit of the input]
  std::size_t self_intersections = 0;  ///< pairs of triangles, on the smoothed points
};

/// A mesh through all points, the map to the sphere, and their quality. It is closed and of genus
/// 0, or that without the triangles over openings.
struct Surface {
  /// 3 x m, indices of vertices, counter-clockwise from outside; m = 2v - 4 of a closed mesh.
  Triangles triangles;
  /// The boundary: closed loops of vertices that are joined by edges of the mesh, the last to the
  /// first, with the surface on the left; the one of most vertices first, each from its lowest
  /// vertex. Empty of a closed mesh.
  std::vector<std::vector<Index>> boundary;
  /// The openings of the surface that were found, open or filled.
  std::vector<Opening> openings;
  Positions sphere;  ///< 3 x v, unit vectors: the embedding of each vertex

  std::vector<Index> inputs;           ///< n entries: the input points of the surface, ascending
  std::vector<Index> vertex_of_input;  ///< n entries: vertex of each of `inputs`
  std::vector<Index> input_of_vertex;  ///< v entries: first input point at that position

  /// Pairs of triangles that intersect, ascending. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  /// 3 x v, the points after smoothing; empty without [unit of the input].
  Positions smoothed;
  /// 3 x v, the points after consolidation, before smoothing: those that all else but
  /// `smoothed` is about; empty without [unit of the input].
  Positions consolidated;
  /// How the embedding unfolded, to `sphere`; empty unless EmbeddingOptions::history_vertices asks
  /// for it.
  EmbeddingHistory history;
  /// v entries: length of the tangential Laplacian of `sphere` [radius]; empty unless
  /// Options::details asks for it.
  std::vector<double> vertex_residuals;

  /// Input points, ascending, that look like outliers; they are vertices even so, one entry for
  /// each. Empty for the graph of nearest neighbours.
  std::vector<Index> outliers;

  MeshTopology topology;       ///< checked on `triangles`
  MeshMeasures measures;       ///< of the mesh on the input's points, or the consolidated ones
  SurfaceDiagnosis diagnosis;  ///< does the cloud look like a closed genus-0 surface?

  ConsolidationReport consolidation;  ///< all zero without consolidation
  EmbeddingReport embedding;          ///< how the embedding was reached
  SmoothingReport smoothing;          ///< all zero without smoothing
  bool is_noisy = false;              ///< the mesh is as rough as noise makes it
  bool is_out_of_time = false;        ///< the time limit ended the optimisation early

  /// Triangles that intersect another one, on the smoothed points if there are some.
  std::size_t intersecting_triangles = 0;
  std::string verdict;            ///< a headline, e.g. "A sound mesh with 2 openings."
  std::vector<Finding> findings;  ///< what to know, and what to do; empty if all is well

  /// The vertex of an input point. \return -1 for a point that is in another surface, or in none
  Index vertexOf(Index input) const {
    const auto found = std::lower_bound(inputs.begin(), inputs.end(), input);
    return found == inputs.end() || *found != input
               ? -1
               : vertex_of_input[static_cast<std::size_t>(found - inputs.begin())];
  }
  /// Number of distinct points. \return v
  std::size_t vertexCount() const { return input_of_vertex.size(); }
  /// Where the vertices were moved. \return `smoothed`, or without smoothing `consolidated`: empty
  /// if they are the input's points
  const Positions& moved() const { return smoothed.cols() > 0 ? smoothed : consolidated; }
  /// Certain openings that the mesh fills. \return their number
  std::size_t filledOpenings() const {
    return static_cast<std::size_t>(
        std::count_if(openings.begin(), openings.end(), [](const Opening& opening) {
          return opening.is_filled && opening.isCertain();
        }));
  }
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

/// Input points that are in no surface, and why; each list is ascending.
struct LeftOut {
  std::vector<Index> not_finite;   ///< with a coordinate that is not finite
  std::vector<Index> outliers;     ///< found by Options::outliers
  std::vector<Index> other_parts;  ///< of parts that were not meshed, and of none

  /// In words. \return e.g. "2 points that are not finite, 3 outliers"; empty if nothing was
  std::string text() const;
};

/// What reconstruct() makes of a cloud.
struct Result {
  /// Those of the parts that were meshed, that of most points first; one with PartsMode::All and
  /// Largest.
  std::vector<Surface> surfaces;
  LeftOut left_out;                   ///< points in none of them
  std::vector<std::string> failures;  ///< why parts could not be meshed, a clause each: faults
  std::vector<StageTime> stages;      ///< in the order of the work, of all surfaces together
  std::string verdict;                ///< a headline, e.g. "3 meshes, all sound."
  std::vector<Finding> findings;      ///< of all surfaces; those of several parts name them

  /// The surface of most points. \return it
  const Surface& surface() const { return surfaces.front(); }
  /// Whether all surfaces can be worked with. \return true if each is usable
  bool isUsable() const {
    return std::all_of(surfaces.begin(), surfaces.end(),
                       [](const Surface& surface) { return surface.isUsable(); });
  }
};

/// @}

}  // namespace spherical_param
