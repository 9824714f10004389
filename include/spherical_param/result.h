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

/// A remark on a mesh, and the option that helps.
struct Finding {
  std::string text;  ///< a clause, e.g. "2 separate parts (395 and 5,633 points)"
  /// The option that helps, a name of optionTable(); empty if none does.
  std::string option = {};
  std::string value = {};  ///< of that option, e.g. "largest"
  bool is_fault = false;   ///< a self-intersection, fold, filled opening, cut handle or joined part
  /// The option of another finding of the same surface deals with this fault as well.
  bool is_consequence = false;
  std::string kind = {};  ///< the same for all findings of a kind, e.g. "openings"
  double size = 0.0;      ///< of what was found; the largest speaks for several of a kind
  /// Of several surfaces: those of which one of the kind is found, numbered from 1, ascending.
  std::vector<Index> parts = {};
};

/// Whether findings include a fault.
///
/// \param findings of a result.
/// \return true if one of them is a fault.
inline bool hasFault(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.is_fault; });
}

/// An opening of the sampled surface: a wide face of its neighbour graph.
struct Opening {
  /// Vertices around it, in order; a vertex that the face passes twice is listed twice.
  std::vector<Index> loop;
  double boundary_length = 0.0;  ///< of the loop [unit of the input]
  /// Length of the vector area of the loop; of one that curls, so that it is certain, the least
  /// area of triangles over it [unit squared].
  double area = 0.0;
  double spacing = 0.0;  ///< mean point spacing at the loop [unit of the input]
  /// min(4 area / boundary_length, boundary_length / pi), the diameter of a disc [unit of the
  /// input].
  double width = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the loop
  /// Certainty in [0, 1]: 0 at the minimum width of 3 spacings, 1 from 9 spacings on, or
  /// for the boundary of a low sheet.
  double certainty = 0.0;
  /// The loop lies in a plane and is not the boundary of a sheet: it may surround a flat face of
  /// the surface without points inside.
  bool is_flat = false;
  /// The longest opening, and all of the surface is on one side of it, like an object without
  /// points on its base.
  bool is_base = false;
  bool is_filled = false;        ///< the mesh has triangles over it
  std::vector<Index> triangles;  ///< of the mesh over a filled opening; in one opening only

  /// Whether it is certainly an opening, not a gap in the sampling or a flat face.
  /// SurfaceMode::Auto leaves it open; filling it is a fault. \return true if it is certain
  bool isCertain() const { return certainty >= 1.0 && !is_flat; }
};

/// Bits of SurfaceDiagnosis::triangle_marks.
namespace triangle_mark {
inline constexpr std::uint8_t self_intersection = 1;  ///< intersects another triangle
inline constexpr std::uint8_t filled_hole = 2;        ///< over a filled, certain opening
inline constexpr std::uint8_t part_bridge = 4;        ///< at the ends of bridges between parts
inline constexpr std::uint8_t outside_graph = 8;      ///< at an edge outside the graph's 2-ring
}  // namespace triangle_mark

/// Two parts of the cloud with a gap between them.
struct PartBridge {
  std::size_t points = 0;        ///< of the smaller part
  std::size_t other_points = 0;  ///< of the larger part
  double gap = 0.0;              ///< length of the shortest bridge [unit of the input]
  double spacing = 0.0;          ///< point spacing at its ends [unit of the input]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the ends of all its bridges
  std::vector<Index> vertices;                       ///< the ends, ascending
};

/// Evidence against a closed genus-0 surface, and its place.
struct SurfaceDiagnosis {
  /// Handles that the cloud certainly has and the mesh has not: it is cut there.
  std::size_t cut_handles = 0;
  /// Handles that the cloud may have, and the mesh has not.
  std::size_t possible_handles = 0;
  std::vector<PartBridge> bridges;  ///< in descending number of points
  std::size_t joined_parts = 0;     ///< that the bridges join; they may form cycles
  bool is_one_sided = false;        ///< like a Moebius strip or a Klein bottle; the mesh is torn
  bool is_on_lines = false;   ///< the points lie along lines, like contours, far from each other
  bool fills_volume = false;  ///< the points fill a volume: there is no surface
  bool is_layered = false;    ///< the points are voxels, three or more across the surface
  bool is_on_curves = false;  ///< the points lie along curves, like centre lines: no surface
  bool is_scattered = false;  ///< a few points, which show no surface
  /// Steps of the coordinates along the axes where single precision lost digits, if they are coarse
  /// for the spacing; 0: none [unit of the input].
  Eigen::Vector3d coarse_steps = Eigen::Vector3d::Zero();
  /// Fraction of the mesh's edges that join points more than two steps apart in the graph; [0, 1].
  double edges_outside_graph = 0.0;
  /// For each triangle, the bits of all findings; empty without Options::details.
  std::vector<std::uint8_t> triangle_marks;

  /// Whether the mesh is folded: too many edges leave the graph.
  /// \return true if more than a tenth of its edges do
  bool isFolded() const;
};

/// What consolidation found and did.
struct ConsolidationReport {
  double noise = 0.0;        ///< median distance of the points from the surface [unit of the input]
  std::size_t merged = 0;    ///< points merged into others, exact duplicates not counted
  double distance_95 = 0.0;  ///< of 95 % of the points from the mesh, at most [unit of the input]
};

/// Why the work on an embedding ended.
enum class StopReason {
  Converged,       ///< the residual is at most the tolerance
  IterationLimit,  ///< PaperOptions::max_iterations was reached
  Stagnated,       ///< a barrier or rounding allows no further step
  Collapsed,       ///< nearly all points are at one place of the sphere: not an embedding
  Unfinished,      ///< no tolerance was set: the work ended with the smoothing sweeps
};

/// Where a barrier keeps an embedding from collapsing.
enum class EmbeddingBarrier {
  None,          ///< nowhere: it holds by itself
  CoarseLevels,  ///< on all levels but the graph itself
  Everywhere,    ///< on all levels that are solved
};

/// Work on one level of the embedding.
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
  /// Unfinished without a tolerance; Stagnated also where a barrier keeps the residual above it.
  StopReason stop_reason = StopReason::Unfinished;
  int iterations = 0;     ///< steps of Newton's method, or of the paper's iteration
  double residual = 0.0;  ///< mean length of the tangential Laplacian at the embedding [radius]
  /// The same before each step on the graph itself, and at the end (Figures 6 and 7 of the paper);
  /// empty without a tolerance.
  std::vector<double> residuals;
  double centroid_norm = 0.0;  ///< length of the mean direction, in [0, 1]; 1: collapsed
  /// The embedding collapsed and was replaced by the directions from the centroid.
  bool fallback_start = false;

  // Only of Method::Default.

  std::vector<LevelReport> levels;  ///< finest (the graph itself) first
  std::size_t start_level = 0;      ///< level on which it started; 0 is the graph itself
  EmbeddingBarrier barrier = EmbeddingBarrier::None;  ///< where it has one

  /// Whether the tolerance was reached. \return true if it was
  bool converged() const { return stop_reason == StopReason::Converged; }
};

/// Distance of a smoothed surface from the given one.
struct SmoothingReport {
  double max_displacement = 0.0;   ///< of a point [unit of the input]
  double mean_displacement = 0.0;  ///< over the points of triangles [unit of the input]
  double rms_displacement = 0.0;   ///< over the points of triangles [unit of the input]
  double volume_before = 0.0;      ///< signed volume enclosed [cubed unit of the input]
  double volume_after = 0.0;       ///< signed volume enclosed [cubed unit of the input]
};

/// What decided which side of a surface its triangles face.
enum class FacedBy {
  Normals,    ///< those of the points
  Viewpoint,  ///< an open surface faces the sensor
  Up,         ///< a low open surface, like terrain, faces along +z
  Outward,    ///< outside of the surface, with its openings filled
};

/// A mesh through all points, its map to the sphere, and their quality. The mesh is a closed,
/// oriented manifold, or such a mesh without the triangles over openings.
struct Surface {
  /// 3 x v, the vertices as they are written: points of the input, consolidated and smoothed if
  /// that was asked for, then those that were added in filled openings [unit of the input].
  Positions points;
  /// 3 x m, indices of vertices, counter-clockwise from outside; m = 2v - 4 + 4g of a closed mesh
  /// of genus g.
  Triangles triangles;
  FacedBy faced_by = FacedBy::Outward;  ///< what decided which side is outside
  /// Boundary loops: vertices joined by edges, the last to the first, with the surface on the left.
  /// The longest loop comes first; each begins at its lowest vertex. Empty for a closed mesh.
  std::vector<std::vector<Index>> boundary;
  /// Openings found in the surface, open or filled.
  std::vector<Opening> openings;
  /// 3 x v, unit vectors: the embedding of each vertex. A view has it, and the published method;
  /// others with TopologyMode::Sphere, a tolerance or Options::details. Empty if the mesh has
  /// handles, added vertices, or only triangles that are certain.
  Positions sphere;

  std::vector<Index> inputs;           ///< n entries: the input points of the surface, ascending
  std::vector<Index> vertex_of_input;  ///< n entries: vertex of each entry of `inputs`
  /// v entries: first input point at that position; of an added vertex the nearest one around,
  /// whose colour it has.
  std::vector<Index> input_of_vertex;

  /// Pairs of triangles that intersect, ascending: all, or a sample. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  std::size_t added_vertices = 0;   ///< in filled openings, by FillMode::Smooth; they come last
  std::size_t smoothly_filled = 0;  ///< openings that have them
  /// v entries: length of the tangential Laplacian of `sphere` [radius]; empty without
  /// Options::details or `sphere`.
  std::vector<double> vertex_residuals;

  /// Stray input points that the mesh contains, ascending, one for each vertex.
  /// Empty for the nearest-neighbour graph.
  std::vector<Index> outliers;

  MeshTopology topology;       ///< checked on `triangles`
  MeshMeasures measures;       ///< of the mesh
  SurfaceDiagnosis diagnosis;  ///< whether the cloud looks like a closed genus-0 surface

  std::optional<ConsolidationReport> consolidation;  ///< unset without consolidation
  EmbeddingReport embedding;                         ///< how the embedding was reached
  std::optional<SmoothingReport> smoothing;          ///< unset without smoothing
  bool is_noisy = false;                             ///< the points look noisy, and are on no grid
  bool is_out_of_time = false;  ///< the time limit ended optimisation or filling early

  std::size_t intersecting_triangles = 0;  ///< triangles that intersect others
  /// The search for intersections ended early, as more than 1 % of the triangles intersect: there
  /// may be more pairs, and more such triangles.
  bool intersections_are_sampled = false;
  /// Triangles that were left out because they would intersect others: each leaves an opening, or
  /// widens one.
  std::size_t left_out_triangles = 0;
  /// A mesh of all points is a tangle: this one has only the triangles that are certain, the small
  /// faces of the graph, may be in several pieces, and has no `sphere`.
  bool has_certain_triangles_only = false;
  std::string verdict;            ///< a headline, e.g. "A sound mesh with 2 openings."
  std::vector<Finding> findings;  ///< remarks and remedies; empty if all is well

  /// The vertex of an input point.
  ///
  /// \param input index of the point in the cloud.
  /// \return the vertex; -1 if the point is not in this surface.
  Index vertexOf(Index input) const {
    const auto found = std::lower_bound(inputs.begin(), inputs.end(), input);
    return found == inputs.end() || *found != input
               ? -1
               : vertex_of_input[static_cast<std::size_t>(found - inputs.begin())];
  }
  /// Number of distinct points and added vertices. \return v
  std::size_t vertexCount() const { return input_of_vertex.size(); }
  /// Number of certain openings that the mesh fills. \return the number
  std::size_t filledOpenings() const {
    return static_cast<std::size_t>(
        std::count_if(openings.begin(), openings.end(), [](const Opening& opening) {
          return opening.is_filled && opening.isCertain();
        }));
  }
  /// Number of handles of the mesh. \return g
  std::size_t genus() const {
    return static_cast<std::size_t>(std::max(0LL, topology.genus.value_or(0)));
  }
  /// Whether the mesh is closed. \return true if it has no boundary
  bool isClosed() const { return boundary.empty(); }
  /// Whether the mesh is usable. \return true if at most 1 % of its triangles intersect
  bool isUsable() const {
    return 100 * intersecting_triangles <= static_cast<std::size_t>(triangles.cols());
  }
  /// Whether the mesh is folded. A smoothed mesh without intersections is not.
  /// \return true if too many of its edges leave the graph
  bool isFolded() const {
    return diagnosis.isFolded() && (!smoothing || intersecting_triangles > 0);
  }
  /// Whether volume, centroid and inertia of `measures` mean something.
  /// \return true if the mesh is closed, usable and not folded
  bool hasVolume() const { return isClosed() && isUsable() && !isFolded(); }
  /// Number of points that repeat an earlier one. \return n - v, minus the points that
  /// consolidation merged
  std::size_t duplicates() const {
    return vertex_of_input.size() + added_vertices - input_of_vertex.size() -
           (consolidation ? consolidation->merged : 0);
  }
};

/// Input points that are in no surface, by reason; each list is ascending.
struct LeftOut {
  std::vector<Index> not_finite;   ///< with a coordinate that is not finite
  std::vector<Index> unused;       ///< of a file with faces, in none of these
  std::vector<Index> outliers;     ///< found by Options::outliers
  std::vector<Index> other_parts;  ///< of parts that were not meshed, or of no part
  std::vector<Index> unmeshed;     ///< of meshed parts: triangles through them would intersect

  /// Number of all of them. \return the number
  std::size_t count() const;
  /// In words. \return e.g. "2 points that are not finite, 3 stray points"; empty if nothing was
  /// left out
  std::string text() const;
};

/// How the place was found from which a cloud is seen.
enum class ViewSource {
  Given,   ///< by the caller or the file
  Origin,  ///< the origin of the coordinates
  Above,   ///< far away along the shortest side of a low sheet, or along z
  Rays,    ///< the points lie on an even pattern of rays from there
};

/// The place from which a cloud is seen as one layer.
struct View {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the sensor [unit of the input]
  ViewSource source = ViewSource::Given;            ///< how it was found
};

/// The result of reconstruct().
struct Result {
  std::optional<View> view;  ///< unset: no place sees the cloud as one layer, or none was wanted
  /// One for each meshed part, the largest first; exactly one with PartsMode::All or Largest.
  std::vector<Surface> surfaces;
  LeftOut left_out;                   ///< points in no surface
  std::vector<std::string> failures;  ///< parts that have no mesh, and why: faults
  std::vector<StageTime> stages;      ///< in the order of the work, of all surfaces together
  std::string verdict;                ///< a headline, e.g. "3 meshes, all sound."
  std::vector<Finding> findings;      ///< of all surfaces; with several, each names its parts

  /// The surface with the most points. \return the surface
  const Surface& surface() const { return surfaces.front(); }
  /// Whether all surfaces are usable. \return true if they are
  bool isUsable() const {
    return std::all_of(surfaces.begin(), surfaces.end(),
                       [](const Surface& surface) { return surface.isUsable(); });
  }
};

/// All surfaces of a result as one mesh: the vertices and triangles of one after those of the
/// other.
struct JoinedMesh {
  Positions points;     ///< 3 x v, Surface::points [unit of the input]
  Triangles triangles;  ///< 3 x m, indices of vertices
  Positions sphere;     ///< 3 x v, Surface::sphere; empty unless each surface has one
  std::vector<Index> input_of_vertex;  ///< v entries, Surface::input_of_vertex
  std::vector<std::uint8_t> is_added;  ///< v entries, 1 of vertices added in filled openings
};

/// Joins the surfaces of a result.
///
/// \param result of reconstruct().
/// \return one mesh; empty without surfaces.
JoinedMesh joined(const Result& result);

/// @}

}  // namespace spherical_param
