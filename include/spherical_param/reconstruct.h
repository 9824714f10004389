#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"
#include "spherical_param/types.h"

#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// Meshes a point cloud: neighbours -> neighbour graph -> stray points and parts -> of each part
/// openings -> embedding on the sphere -> triangulation there -> optimisation on the points ->
/// verdict.
///
/// \param points 3 x n, of which at least 4 are finite, distinct and not all in one plane, no
///               coordinate beyond 1e100. Points that are not finite are left out. The topology is
///               sound whatever their differences; below 1e-90 of the cloud's extent
///               self-intersections are no longer found exactly, and the geometry is arbitrary far
///               sooner: see doc/numbers.md.
/// \param options the defaults need no tuning.
/// \param search_of makes the search that is used for neighbours; empty: a k-d tree in double
///               precision. It is called once at most, with the first point at each position, as is
///               the search that it returns, from the calling thread; what they throw is passed on.
///               Not used for consolidated points, which have moved.
/// \return the surfaces, and what was left out. Triangles index vertices of their surface.
/// \throw InvalidInput for bad points or options; ComputeError; Cancelled. A part that cannot be
///        meshed is left out, and a finding says so, unless none can be.
///
/// Guaranteed: each mesh is closed, manifold, consistently oriented, of genus 0 and in one piece,
/// and every distinct point of its part, or consolidated one, is a vertex. The same input and
/// options give the same result, bit by bit, whatever the number of threads. Reentrant: no state is
/// shared between calls.
///
/// Not guaranteed: that a mesh is free of self-intersections or near the sampled surface;
/// `verdict`, `findings` and `diagnosis` say how far to trust it.
/// Cost: O(n log n), typically; with the iterative embedding iterations * O(n k) more. Below 2 KB
/// of memory a point; 3 KB for the multilevel embedding with a tolerance on a graph of 25
/// neighbours.
Result reconstruct(const Positions& points, const Options& options = {},
                   const NeighborSearchFactory& search_of = {});

/// The outliers that reconstruct() leaves out.
///
/// \param points 3 x n.
/// \param options Options::outliers and outlier_sigma tell which; threads, progress.
/// \return their numbers, ascending. Of points at one position all are outliers or none.
/// \throw InvalidInput as above; Cancelled.
/// Cost: that of a neighbour graph.
std::vector<Index> findOutliers(const Positions& points, const Options& options);

/// The parts of a cloud that reconstruct() meshes with PartsMode::Each.
///
/// \param points 3 x n.
/// \param options Options::min_points, outliers; threads, progress.
/// \return the numbers of the points of each part, ascending; that of most points first. None if
/// all
///         are too small.
/// \throw InvalidInput as above; Cancelled.
/// Cost: that of a neighbour graph.
std::vector<std::vector<Index>> findParts(const Positions& points, const Options& options = {});

/// @}

}  // namespace spherical_param
