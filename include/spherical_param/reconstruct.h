#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"

#include <optional>
#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// What is known of a cloud besides its points.
struct CloudInfo {
  Positions normals;                         ///< 3 x n, of each point, of any length; or empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< of the sensor [unit of the input]
  std::vector<Index> unused;  ///< points to leave out, ascending: those that no face of a mesh uses
};

/// The viewpoint of a cloud. The origin, which stands for an unknown one, counts if the points are
/// in rows, or if it is outside of their box.
///
/// \param points   3 x n, finite or not.
/// \param sensor   as file or message say.
/// \param has_rows the sensor has seen the points in rows.
/// \return the sensor; unset if it is unknown.
std::optional<Eigen::Vector3d> viewpointOf(const Positions& points, const Eigen::Vector3d& sensor,
                                           bool has_rows);

/// Meshes a point cloud: neighbours -> neighbour graph -> stray points and parts -> of each part
/// openings -> faces of the graph or, where these have defects, embedding on the sphere and
/// triangulation there -> optimisation on the points -> verdict.
///
/// \param points 3 x n, at least 4 of them finite, distinct and not all in one plane; coordinates
///               up to 1e100. Points that are not finite are left out. The topology is always
///               sound; differences below 1e-90 of the extent make self-intersections inexact, and
///               the geometry is arbitrary far sooner: see doc/reference.md.
/// \param options the defaults need no tuning.
/// \param search_of makes the neighbour search; empty: a k-d tree in double precision. It is called
///               at most once, with the first point at each position. It and its search run in the
///               calling thread; their exceptions are passed on. Not used once outliers are left
///               out, for one of several parts, nor for consolidated points.
/// \param info    normals decide which side of a surface is outside; else an open one faces the
///               viewpoint, or up if it is low; see Surface::faced_by.
/// \return the surfaces, and what was left out. Triangles index vertices of their surface.
/// \throw InvalidInput for bad points or options; ComputeError; Cancelled. A part that cannot be
///        meshed is left out and reported in Result::failures; if all parts fail, the first error
///        is thrown.
///
/// Guaranteed: each mesh is manifold and consistently oriented, and closed and in one piece unless
/// it has openings. Surface::genus() counts its handles; with HandleMode::None it has none.
/// Every distinct (or consolidated) point of its part is a vertex, but for LeftOut::unmeshed, which
/// IntersectionMode::Keep leaves empty. The same input and options give the same result, bit by
/// bit, for any number of threads, unless a time limit ends the work. Reentrant.
///
/// Not guaranteed: a mesh free of self-intersections where these are kept or too many, near the
/// sampled surface, or of its genus; `verdict`, `findings` and `diagnosis` say how far to trust it.
/// Cost: O(n log n), typically; Method::Paper adds iterations * O(n k). Memory: below 1 KB a point.
Result reconstruct(const Positions& points, const Options& options = {},
                   const NeighborSearchFactory& search_of = {}, const CloudInfo& info = {});

/// The outliers that reconstruct() leaves out, but for those that turn out to fill an opening.
///
/// \param points 3 x n.
/// \param options outliers, outlier_sigma, threads, progress
/// \return their indices, ascending. Points at one position are outliers together or not at all.
/// \throw InvalidInput as above; Cancelled.
/// Cost: that of a neighbour graph.
std::vector<Index> findOutliers(const Positions& points, const Options& options);

/// The parts of a cloud that reconstruct() meshes with PartsMode::Each, without points that turn
/// out to fill an opening.
///
/// \param points 3 x n.
/// \param options min_points, outliers, threads, progress
/// \return the indices of the points of each part, ascending; the largest part first. Empty if all
///         parts are too small.
/// \throw InvalidInput as above; Cancelled.
/// Cost: that of a neighbour graph.
std::vector<std::vector<Index>> findParts(const Positions& points, const Options& options = {});

/// @}

}  // namespace spherical_param
