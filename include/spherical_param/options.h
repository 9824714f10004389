#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <optional>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// The topology of the mesh.
enum class TopologyMode {
  /// What the cloud shows: a surface for each part, with certain openings and handles, without
  /// certain outliers.
  Scan,
  /// One closed surface of genus 0 through every point, whatever the cloud shows: the guarantee of
  /// the paper. Method::Paper makes no other.
  Sphere,
};

/// Which points are left out first because they belong to no surface.
enum class OutlierMode {
  AsTopology,  ///< Auto for TopologyMode::Scan, else None
  None,        ///< no points; a finding reports likely outliers
  Auto,  ///< stray points: isolated points, small clusters, nets, isolated points near a surface
  /// points too far from the average of their neighbours (Zwicker and Gotsman 2004, section 4.2).
  Deviation,
};

/// Which parts of a cloud are meshed. A part is a set of points that neighbours connect.
enum class PartsMode {
  AsTopology,  ///< Each for TopologyMode::Scan, else All
  All,         ///< all together, as one surface
  Largest,     ///< the part with the most points
  Each,        ///< each part as a mesh of its own
};

/// Where a cloud is seen from. If a place sees it as one layer, the directions from there are the
/// embedding, and the mesh ends where the depth jumps.
enum class ViewMode {
  /// The first of these that sees one layer: the viewpoint of the cloud, the origin, far above an
  /// elevation grid, a place that is searched for, far above a low sheet. If none does, and for
  /// TopologyMode::Sphere, None.
  Auto,
  None,   ///< no place
  Up,     ///< far above, along z
  Place,  ///< Options::viewpoint
};

/// Whether points are consolidated before meshing.
enum class ConsolidationMode {
  AsTopology,  ///< for TopologyMode::Scan without smoothing, Auto of noisy parts; else None
  None,        ///< the mesh goes through the given points
  Auto,        ///< points are moved to the sampled surface and merged within their noise
};

/// How a cloud is meshed.
enum class Method {
  /// Tangent Delaunay graph, embedding from coarse to fine, exact Delaunay triangulation of the
  /// sphere, optimisation on the points.
  Default,
  /// As Zwicker and Gotsman 2004 published it: nearest-neighbour graph, the iteration of Figure 3,
  /// convex hull.
  Paper,
};

/// Weights of the Laplacian (Zwicker and Gotsman 2004, section 3, equations 2 to 4), normalised so
/// that they sum to 1 at each node.
enum class EdgeWeights {
  Uniform,        ///< w_ij = 1
  InverseLength,  ///< w_ij = 1 / |p_i - p_j|
  Adaptive,       ///< w_ij = |u_i - u_j| / |p_i - p_j|, recomputed in each iteration; equation 4
};

/// Parameters of Method::Paper.
struct PaperOptions {
  int k = 25;  ///< nearest neighbours of each point; >= 3 (k >= n: n - 1 are used)
  EdgeWeights weights = EdgeWeights::Adaptive;  ///< of the Laplacian
  /// Fraction of the tangential Laplacian by which an iteration moves each point; (0, 1].
  double damping = 0.5;
  /// Maximum number of iterations, as in Table 1; >= 0. 0: the embedding is the projection of the
  /// points from their centroid.
  int max_iterations = 1600;
};

/// Parameters of the embedding.
struct EmbeddingOptions {
  /// Mean length of the tangential Laplacian at which the embedding counts as converged [radius of
  /// the sphere]; [0, 1]. Unset: 1e-8 for Method::Paper; Method::Default then ends with its sweeps.
  std::optional<double> tolerance;
};

/// Whether openings of the sampled surface are filled.
enum class SurfaceMode {
  AsTopology,  ///< Auto for TopologyMode::Scan, else Closed
  Closed,      ///< all are filled: the mesh is always closed
  Open,        ///< all stay open
  Auto,        ///< certain openings stay open, others are filled
};

/// How openings are filled.
enum class FillMode {
  Flat,  ///< without further vertices
  /// Vertices are added, as densely as around, and go on as the surface around does.
  Smooth,
};

/// Whether the mesh has the handles of the sampled surface.
enum class HandleMode {
  AsTopology,  ///< Auto for TopologyMode::Scan, else None
  None,        ///< no handles: the mesh is one sphere, or one with openings
  Auto,        ///< those that are certain
};

/// What happens to triangles that still intersect at the end.
enum class IntersectionMode {
  AsTopology,  ///< Auto for TopologyMode::Scan, else Keep
  /// As Remove, but a usable mesh of a surface without openings stays closed: what cannot be taken
  /// apart by leaving out points is kept.
  Auto,
  /// They are taken apart: by other triangles, else by leaving out triangles and points. A tangle
  /// keeps only the triangles that are certain, unless it is smoothed; one part of several without
  /// enough of them is left out.
  Remove,
  Keep,  ///< they are counted; every point is in the mesh
};

/// Parameters of reconstruct(). The defaults need no tuning. optionTable() lists the options of
/// tools, Python and ROS with their ranges.
struct Options : Execution {
  Method method = Method::Default;  ///< how the cloud is meshed
  PaperOptions paper;               ///< of Method::Paper
  /// The topology of the mesh. `outliers`, `parts`, `surface`, `handles` and `intersections` each
  /// override a part of it.
  TopologyMode topology = TopologyMode::Scan;
  /// Where the cloud is seen from. With TopologyMode::Sphere or SurfaceMode::Closed the directions
  /// from there are the embedding.
  ViewMode view = ViewMode::Auto;
  /// The place of ViewMode::Place [unit of the input].
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();
  OutlierMode outliers = OutlierMode::AsTopology;  ///< which points are left out first
  /// OutlierMode::Deviation: outliers deviate by more than the mean and this number of standard
  /// deviations; [0, 1000].
  double outlier_sigma = 4.0;
  PartsMode parts = PartsMode::AsTopology;  ///< which parts are meshed
  /// Minimum number of distinct points of a part; >= 4. Smaller parts are left out. No effect with
  /// PartsMode::All.
  int min_points = 50;
  /// Whether points are consolidated before meshing.
  ConsolidationMode consolidation = ConsolidationMode::AsTopology;
  EmbeddingOptions embedding;  ///< how the graph is embedded
  /// Strength of smoothing, in steps of the paper's section 4.2; [0, 10000], 0: none.
  /// Method::Default then optimises the mesh on the smoothed points.
  int smoothing = 0;

  /// Whether openings are filled. Only Method::Default finds them. Its embedding leaves room for
  /// them in any case, so that the surface beside them does not fold.
  SurfaceMode surface = SurfaceMode::AsTopology;
  /// Openings of up to this number of edges are filled in any case; >= 0.
  int fill_holes = 0;

  /// How openings are filled, if they are. With vertices added, a surface has no `sphere`.
  FillMode fill = FillMode::Flat;

  /// Whether the mesh has the handles of the surface. Only Method::Default finds them.
  HandleMode handles = HandleMode::AsTopology;

  /// What happens to triangles that intersect. No effect with Method::Paper.
  IntersectionMode intersections = IntersectionMode::AsTopology;

  std::uint32_t seed = 1;  ///< of all random choices
  /// Fill Surface::sphere, where a mesh needs no embedding, Surface::vertex_residuals and
  /// SurfaceDiagnosis::triangle_marks.
  bool details = false;
};

/// Replaces AsTopology by what the topology and the method imply.
///
/// \param options any.
/// \return the same otherwise.
Options withTopology(Options options);

/// Checks the ranges of all options. reconstruct() does so too; callers may check before long work.
///
/// \param options to check.
/// \throw InvalidInput with the option, its value and the remedy.
void checkOptions(const Options& options);

/// @}

}  // namespace spherical_param
