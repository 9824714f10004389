#pragma once

#include "graph.h"
#include "spherical_param/options.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup optimization
/// @{

/// Parameters of optimizeMesh().
struct OptimizationOptions {
  OptimizationMethod method = OptimizationMethod::Full;  ///< how far
  /// After work on smoothed positions of a noisy cloud, untangle on the given points too, if that
  /// is not in vain.
  bool finish_on_points = true;
};

/// What one phase of the optimisation did.
struct OptimizationPhase {
  /// "flips", "relocate", "ruin and recreate", "flip apart", "untangle", "polish", or "roll back"
  /// (of the polish)
  std::string name;
  std::size_t tried = 0;       ///< vertices or parts that were taken out
  std::size_t moves = 0;       ///< flips, or of these those that stayed at another place
  double energy_before = 0.0;  ///< at its beginning, in its own terms [unit of the input]
  double energy = 0.0;         ///< at its end [unit of the input]
  /// Pairs of triangles that intersect at its end; none if not looked for.
  std::optional<std::size_t> self_intersections;
  double seconds = 0.0;  ///< wall time [s]
};

/// How a mesh was optimised.
struct OptimizationReport {
  std::vector<OptimizationPhase> phases;  ///< in the order of the work
  double energy = 0.0;  ///< equation (1) of optimizeMesh(), on the given points [their unit]
  double rough = 0.0;   ///< fraction of rough vertices after the first flips, in [0, 1]
  /// Steps of smoothing of the positions that the mesh was optimised on because the cloud is noisy;
  /// 0: it is not.
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
  OptimizationReport report;  ///< how it came about
};

/// Changes the triangles of a closed genus-0 mesh on fixed points, for the least energy
///
///   E = sum over edges of length * angle + mu * sum over triangles of min(R, 4 * longest side) (1)
///
/// with the angle between the normals of an edge's triangles [rad], the circumradius R, and mu =
/// 0.3: the total absolute mean curvature, and what keeps triangles from becoming needles.
///
/// Flips: the edge that gains most, until none gains; in terms that suit the cloud, as in the
///           polish, but mu = 0.3 where that has 0.8.
/// Relocate: vertices at sharp edges, or far on the mesh from their neighbours in the graph, are
///           taken out and put back where they cost least.
/// Ruin and recreate: around edges that are folded, parts of 4 to 32 vertices are taken out and put
///           back in random order.
/// Flip apart: before rounds of untangling by number, edges near triangles that intersect are
/// flipped, one or two at a time, so that
///           fewer do.
/// Untangle: parts of up to 96 vertices around triangles that intersect are taken out and put back,
///           by the energy, then by the number of intersections.
/// Polish:   flips (and relocation) again, in terms that suit the cloud. Where the sampling follows
///           the surface's curvature (simplified and designed models), or is random: angle^1.5 and
///           mu = 0.8.
///           Elsewhere (scans, even samplings) angles count only beyond what is typical at a place,
///           and mu = 4: nearly the Delaunay triangulation on the surface, but for sharp edges.
///           Triangles that intersect thereafter are untangled, or else the polish is rolled back.
///
/// Only three moves touch the mesh - an edge is flipped whose new ends are not joined yet, a
/// triangle is split by a vertex, three triangles around a vertex are merged - and each keeps it
/// closed, manifold, oriented and of genus 0, whatever the arithmetic.
///
/// \param points    3 x n, finite, distinct; extent about 1, or such that areas are numbers.
/// \param triangles 3 x (2n - 4), over all points; closed, manifold, oriented, of genus 0.
/// \param graph     n nodes, the neighbours of each point.
/// \param options how far
/// \param seed  of the random choice of parts that are taken out.
/// \param execution threads, progress, time limit
/// \return the mesh: the same, bit by bit, for any number of threads.
/// \throw Cancelled.
///
/// Not guaranteed: that no triangles intersect; that the energy is the least.
/// Cost: O(n log n); repairs end after work that is proportional to n.
MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options = {},
                              std::uint32_t seed = 1, const Execution& execution = {});

/// @}

}  // namespace spherical_param
