#pragma once

#include "spherical_param/neighbor_graph.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// What a cloud shows, judged by its mesh and its neighbour graph.
enum class SurfaceKind {
  ClosedGenus0,  ///< nothing speaks against a closed surface without handles, in one piece
  Open,          ///< the surface has openings, which the mesh fills or leaves open
  Handles,       ///< the surface has handles, which the mesh cuts
  SeveralParts,  ///< there are several surfaces, which the mesh joins
  Unclear,       ///< the mesh leaves the graph in too many places: noise, or the mesh is folded
};

/// Bits of SurfaceDiagnosis::triangle_marks.
struct TriangleMarks {
  static constexpr std::uint8_t self_intersection = 1;  ///< intersects another: of a Result alone
  static constexpr std::uint8_t filled_hole = 2;        ///< part of a filled hole
  static constexpr std::uint8_t handle = 4;             ///< at the ends of torn edges of a handle
  static constexpr std::uint8_t part_bridge = 8;        ///< at the ends of bridges between parts
  static constexpr std::uint8_t outside_graph = 16;     ///< at an edge outside the graph's 2-ring
};

/// Parameters of diagnoseSurface().
struct DiagnosisOptions {
  /// Maximum number of vertices listed with each finding; FilledHole::loops are complete even so.
  std::size_t max_vertices = 64;
  bool mark_triangles = false;  ///< fill SurfaceDiagnosis::triangle_marks
  /// Count the graph's cycles, which tell handles from folds. Where a mesh is folded, that takes
  /// longer than all the rest; without it, what may be either is SurfaceKind::Unclear.
  bool count_cycles = true;
};

/// Connected triangles over a place without points that is wide against the distance of the points
/// around it: an opening of the surface, or a cut through a handle or between parts.
struct FilledHole {
  SurfaceKind cause = SurfaceKind::Open;  ///< or Handles, SeveralParts, of which it is a trace
  std::size_t triangles = 0;              ///< of the mesh, over the place
  double area = 0.0;                      ///< [squared unit of the input]
  double boundary_length = 0.0;           ///< of all its rims [unit of the input]
  double diameter = 0.0;  ///< of the disc that area and boundary make [unit of the input]
  double spacing = 0.0;   ///< distance of the points at its rim [unit of the input]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< centroid of its triangles
  std::vector<Index> vertices;                       ///< of its rim, ascending
  /// Its boundary: closed loops of vertices that are joined by edges of the mesh, the last to the
  /// first, with the filled hole on the left seen from outside. Complete whatever max_vertices is;
  /// the longest first, each from its lowest vertex. Several where the filled hole has more than
  /// one rim.
  std::vector<std::vector<Index>> loops;
};

/// Neighbours in the graph, along the surface, that the mesh tears apart.
struct CollapsedHandle {
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
  std::vector<FilledHole> filled_holes;          ///< by falling area
  std::vector<CollapsedHandle> handles;          ///< by falling number of edges
  std::vector<PartBridge> bridges;               ///< by falling number of points
  bool is_one_sided = false;                     ///< found with openings alone: the mesh tears it
  std::size_t boundaries = 0;  ///< loops around openings that the mesh leaves open
  /// Fraction of the mesh's edges that join points more than two steps apart in the graph, in [0,
  /// 1].
  double edges_outside_graph = 0.0;
  /// Handles of the surface, counted by the cycles of the graph whatever the mesh does to them;
  /// none where that was not needed, as neighbours are nowhere torn apart, or unknown.
  std::optional<int> genus;
  /// For each triangle, the TriangleMarks of all findings, listed or not; empty unless
  /// DiagnosisOptions::mark_triangles asks for it.
  std::vector<std::uint8_t> triangle_marks;

  /// Whether nothing speaks against a closed genus-0 surface. \return true if nothing does
  bool looksClosedGenus0() const { return kind == SurfaceKind::ClosedGenus0; }
  /// Whether the mesh leaves the graph in too many places to show the surface, whatever that is.
  /// \return true if more than a tenth of its edges do
  bool isFolded() const;
  /// Filled holes that are a trace of nothing else. \return their number
  std::size_t openings() const;
};

/// Decides whether a cloud looks like a closed genus-0 surface: the mesh always is one, whatever
/// the cloud shows. An opening is closed by triangles that leave the graph and are long against the
/// distance of the points around them; a handle is cut, and neighbours become distant; the graph
/// itself falls into the parts that were joined by bridges.
///
/// \param points    3 x n, finite; extent about 1, or at least such that areas are numbers.
/// \param triangles 3 x m, a manifold over the points: closed, or with openings that are left open.
/// \param graph     n nodes, lengths in the unit of the points. The thresholds were measured on
///                  local Delaunay neighbourhoods and hold for the 8 nearest neighbours as well; of
///                  a graph with a mean degree above 12, the 8 shortest edges of each point are
///                  used.
/// \param bridges   edges of the graph that join parts (GraphReport::bridges).
/// \param options what is listed
/// \param threads OpenMP threads; 0: as many as OpenMP would use; [0, 1024].
/// \return what was found, the same for any number of threads.
/// \throw InvalidInput for sizes that disagree, no triangles, an index or an option out of range.
/// Cost: O(n) where nothing is wrong.
///
/// Handles are sought where there is one part only: by neighbours that the mesh tears apart, where
/// it is not folded, and then counted by the cycles of the graph, which do not depend on the mesh.
/// Torn neighbours in a graph without such cycles are no handle. Where the mesh is folded, as it is
/// over most handles of many points, the cycles alone are asked, unless there is the rim of an
/// opening.
///
/// Not guaranteed: openings of less than some 8 spacings and handles of less than some 9 points
/// around are taken for uneven sampling. A place without points in the middle of dense ones is a
/// filled hole, also where it is flat and nothing is missing. Where the mesh is folded, no filled
/// holes are reported.
/// Where noise is as large as the spacing, cycles are not counted: SurfaceDiagnosis::genus is
/// unset. One handle may be cut in several places.
SurfaceDiagnosis diagnoseSurface(const Positions& points, const Triangles& triangles,
                                 const Graph& graph, const std::vector<Bridge>& bridges,
                                 const DiagnosisOptions& options = {}, int threads = 0);

/// @}

}  // namespace spherical_param
