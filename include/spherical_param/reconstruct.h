#pragma once

#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param {

/// \addtogroup pipeline
/// @{

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
Surface reconstruct(const Positions& points, const Options& options = {});

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
Surface reconstruct(const Positions& points, const NeighborLists& lists,
                    const Options& options = {}, const NeighborSearch& search = {});

/// @}

}  // namespace spherical_param
