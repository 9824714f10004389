#pragma once

#include "graph.h"
#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup optimization
/// @{

/// How a mesh on fixed points is optimised.
enum class OptimizationMethod {
  None,   ///< not at all
  Flips,  ///< edge flips only
  Full,   ///< flips, relocation of vertices, ruin and recreate
};

/// Parameters of optimizeMesh().
struct OptimizationOptions {
  OptimizationMethod method = OptimizationMethod::Full;  ///< which phases
  /// After work on smoothed positions of a noisy cloud, also untangle on the given points, unless
  /// there are too many intersections.
  bool finish_on_points = true;
};

/// Report of one phase.
struct OptimizationPhase {
  /// "flips", "relocate", "ruin and recreate", "flip apart", "untangle", "polish", or "roll back"
  /// (of the polish)
  std::string name;
  std::size_t tried = 0;       ///< vertices or parts taken out
  std::size_t moves = 0;       ///< flips, or successful relocations or rebuilds
  double energy_before = 0.0;  ///< at its beginning, of the phase's own energy [unit of the input]
  double energy = 0.0;         ///< at its end [unit of the input]
  /// Pairs of triangles that intersect at its end; unset if not counted.
  std::optional<std::size_t> self_intersections;
  double seconds = 0.0;  ///< wall time [s]
};

/// Report of an optimisation.
struct OptimizationReport {
  std::vector<OptimizationPhase> phases;  ///< in the order of the work
  double energy = 0.0;  ///< equation (1) of optimizeMesh(), on the given points [their unit]
  double rough = 0.0;   ///< fraction of rough vertices after the first flips, in [0, 1]
  /// Steps of smoothing of the positions for the optimisation of a noisy cloud; 0: not noisy.
  int noise_steps = 0;
  /// With `noise_steps`: pairs that intersected on the smoothed points, before the finish.
  std::size_t smoothed_self_intersections = 0;
  bool is_out_of_time = false;  ///< the time limit ended it early
  double alignment = 0.0;       ///< how far the sampling follows the curvature, in [-1, 1]
  double unevenness = 0.0;      ///< relative deviation of the distances of a point's neighbours
};

/// An optimised mesh.
struct MeshOptimization {
  Triangles triangles;  ///< 3 x m, as many as before
  /// Pairs of triangles that intersect, on the given points; with `noise_steps` and without
  /// OptimizationOptions::finish_on_points, on the smoothed ones. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  OptimizationReport report;  ///< phases, noise, sampling
};

/// Changes the triangles of a closed genus-0 mesh on fixed points, for the least energy
///
///   E = sum over edges of length * angle + mu * sum over triangles of min(R, 4 * longest side) (1)
///
/// with the angle between the normals of an edge's triangles [rad], the circumradius R, and mu =
/// 0.3: the total absolute mean curvature, and a penalty on needles.
///
/// Flips:    the edge that gains most, until none gains; with the energy of the polish, but mu =
/// 0.3
///           instead of 0.8.
/// Relocate: takes out vertices at sharp edges, or far on the mesh from their neighbours in the
///           graph, and puts them back where they cost least.
/// Ruin and recreate: takes out parts of 4 to 32 vertices around folded edges and puts them back in
///           random order.
/// Flip apart: before untangling by number, flips one or two edges near intersecting triangles at a
///           time, so that fewer intersect.
/// Untangle: ruin and recreate with parts of up to 96 vertices around intersecting triangles, by
///           energy, then by the number of intersections.
/// Polish:   flips and relocation with an energy that suits the cloud. If the sampling follows the
///           surface's curvature (simplified and designed models) or is random: angle^1.5 and mu =
///           0.8. Otherwise (scans, even samplings) angles count beyond the typical angle at a
///           place, and mu = 4: nearly the Delaunay triangulation on the surface, except for sharp
///           edges. New intersections are untangled, or the polish is rolled back.
///
/// The mesh changes only by the moves of internal::SphereMesh, so it stays closed, manifold,
/// oriented and of genus 0, whatever the arithmetic.
///
/// \param points    3 x n, finite, distinct, of an extent about 1.
/// \param triangles 3 x (2n - 4), over all points; closed, manifold, oriented, of genus 0.
/// \param graph     n nodes, the neighbours of each point.
/// \param options method
/// \param seed  of the random choice of parts.
/// \param execution threads, progress, time limit
/// \return the mesh: the same, bit by bit, for any number of threads.
/// \throw Cancelled.
///
/// Not guaranteed: a mesh without intersections; the minimum of the energy.
/// Cost: O(n log n); the work of repairs is limited in proportion to n.
MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options = {},
                              std::uint32_t seed = 1, const Execution& execution = {});

/// @}

}  // namespace spherical_param
