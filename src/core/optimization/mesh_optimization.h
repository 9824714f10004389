#pragma once

#include "graph.h"
#include "intersecting_pairs.h"
#include "open_places.h"
#include "sphere_mesh.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace spherical_param::internal {

/// Parameters of optimizeMesh().
struct OptimizationOptions {
  /// Of the surface, over which triangles do not bend and do not intersect; nullptr: it is closed.
  const OpenPlaces* openings = nullptr;
  /// After work on smoothed positions of a noisy cloud, also untangle on the given points, unless
  /// there are too many intersections.
  bool finish_on_points = true;
  std::uint32_t seed = 1;  ///< of the random choice of parts
  /// \see isEvenlySampled; unset: it is found.
  std::optional<bool> is_even = {};
  double fraction = 1.0;  ///< of a cloud's points that this part has, and of the work
};

/// Report of an optimisation.
struct OptimizationReport {
  std::size_t recreated = 0;    ///< vertices of parts that were taken out and put back
  bool is_noisy = false;        ///< the optimisation began on smoothed positions
  bool is_out_of_time = false;  ///< the time limit ended it early
};

/// An optimised mesh.
struct MeshOptimization {
  SphereMesh mesh;
  /// On the given points; if noisy and without OptimizationOptions::finish_on_points, on the
  /// smoothed ones. A sample if the mesh is a tangle.
  IntersectingPairs intersecting;
  OptimizationReport report;
};

/// Changes the triangles of a closed mesh on fixed points, for the least energy
///
///   E = sum over edges of length * angle + mu * sum over triangles of min(R, 4 * longest side) (1)
///
/// with the angle between the normals of an edge's triangles [rad], the circumradius R, and mu =
/// 0.3: the total absolute mean curvature, and a penalty on needles.
///
/// - flips: the edge that gains most, until none gains; with the energy of the polish, but mu = 0.3
///   instead of 0.8
/// - relocate: takes out vertices at sharp edges, or far on the mesh from their neighbours in the
///   graph, and puts them back where they cost least
/// - unfold: takes out parts of 4 to 32 vertices around folded edges and puts them back in random
///   order
/// - untangle: the same with up to 96 vertices around intersecting triangles, by energy, then by
///   the number of intersections that are left after flips
/// - polish: flips, and relocation where the sampling is not even, with an energy that suits the
///   sampling; then untangles again, or goes back to the mesh before
///
/// If the sampling follows the surface's curvature (simplified and designed models) or is random,
/// the polish has angle^1.5 and mu = 0.8. Otherwise (scans, even samplings) angles count beyond 10
/// degrees, and mu = 4: nearly the Delaunay triangulation on the surface, except for sharp edges.
///
/// The mesh changes only by the moves of SphereMesh, so it stays closed, manifold,
/// oriented and of the same genus, whatever the arithmetic.
///
/// \param points    3 x n, finite, distinct, of an extent about 1.
/// \param mesh      in one piece over all points.
/// \param graph     n nodes, the neighbours of each point.
/// \param options openings, seed
/// \param execution threads, progress, time limit
/// \return the mesh: the same, bit by bit, for any number of threads.
/// \throw Cancelled.
///
/// Not guaranteed: a mesh without intersections; the minimum of the energy.
/// Cost: O(n log n); the work of repairs is limited in proportion to n.
MeshOptimization optimizeMesh(const Positions& points, SphereMesh mesh, const Graph& graph,
                              const OptimizationOptions& options = {},
                              const Execution& execution = {});

/// The first step of optimizeMesh() alone: flips the edge that gains most, until none gains.
///
/// \param points, mesh, graph, options, execution as there.
/// \return the mesh.
SphereMesh flipMesh(const Positions& points, SphereMesh mesh, const Graph& graph,
                    const OptimizationOptions& options, const Execution& execution);

}  // namespace spherical_param::internal
