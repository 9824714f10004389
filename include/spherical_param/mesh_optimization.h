#pragma once

#include "spherical_param/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup optimization
/// @{

/// How far a mesh on fixed points is optimised.
enum class OptimizationMethod {
  None,   ///< not at all
  Flips,  ///< edge flips alone
  Full,   ///< flips, vertices moved to other places of the mesh, parts taken out and put back
};

/// Parameters of optimizeMesh().
struct OptimizationOptions {
  OptimizationMethod method = OptimizationMethod::Full;  ///< how far
  std::uint32_t seed = 1;  ///< of the random choice of parts that are taken out
  int threads = 0;         ///< OpenMP threads; 0: as many as OpenMP would use; [0, 1024]
  /// Given a mesh of the points that is rough because they are noisy, and a number of smoothing
  /// steps, answers with less noisy positions (3 x n) in their place, on which the mesh is then
  /// optimised. Asked a few times, with more and more steps, by OptimizationMethod::Full. May be
  /// empty: noise then costs time, and leaves self-intersections.
  std::function<Positions(const Triangles&, int steps)> smoother;
  /// After work on positions of `smoother`, untangle on the given points too, if that is not in
  /// vain.
  bool finish_on_points = true;
  /// Told the share of the work that is done, in [0, 1), which never falls; about in proportion to
  /// the time where nothing has to be untangled. May throw to end the work. May be empty. Called
  /// from the calling thread only.
  std::function<void(double)> progress;
};

/// What one phase of the optimisation did.
struct OptimizationPhase {
  /// "flips", "relocate", "recreate", "untangle", "polish", or "unpolish": the polish was taken
  /// back
  std::string name;
  std::size_t tried = 0;       ///< vertices or parts that were taken out
  std::size_t moves = 0;       ///< flips, or of these those that stayed at another place
  double energy_before = 0.0;  ///< at its beginning, in its own terms [unit of the input]
  double energy = 0.0;         ///< at its end [unit of the input]
  /// Pairs of triangles that intersect at its end; none if not looked for.
  std::optional<std::size_t> self_intersections;
  double seconds = 0.0;  ///< wall time [s]
};

/// An optimised mesh, and how it came about.
struct MeshOptimization {
  Triangles triangles;                    ///< 3 x m, as many as before
  std::vector<OptimizationPhase> phases;  ///< in the order of the work
  double energy = 0.0;  ///< equation (1) of optimizeMesh(), on the given points [their unit]
  /// Pairs of triangles that intersect, on the given points; with `smoothing_steps` and without
  /// OptimizationOptions::finish_on_points, on the smoothed ones. \see findSelfIntersections
  std::vector<std::array<Index, 2>> self_intersections;
  /// With `smoothing_steps`: pairs that intersected on the smoothed points, before the finish.
  std::size_t smoothed_self_intersections = 0;
  double rough = 0.0;       ///< share of rough vertices after the first flips, in [0, 1]
  int smoothing_steps = 0;  ///< optimised on positions of OptimizationOptions::smoother; 0: not
  double alignment = 0.0;   ///< how far the sampling follows the curvature, in [-1, 1]
  double unevenness = 0.0;  ///< relative deviation of the distances of a point's neighbours
};

/// Changes the triangles of a closed genus-0 mesh on fixed points, for the least energy
///
///   E = sum over edges of length * angle + mu * sum over triangles of min(R, 4 * longest side) (1)
///
/// with the angle between the normals of an edge's triangles [rad], the circumradius R, and mu =
/// 0.3: the total absolute mean curvature, and what keeps triangles from becoming needles.
///
/// Flips:    the edge that gains most, until none gains; in terms that suit the cloud, as in the
///           polish, but mu = 0.3 where that has 0.8.
/// Relocate: vertices at sharp edges, or far on the mesh from their neighbours in the graph, are
///           taken out and put back where they cost least.
/// Recreate: around edges that are folded, parts of 4 to 32 vertices are taken out and put back in
///           random order.
/// Untangle: the same with up to 96 vertices around triangles that intersect, until none do.
/// Polish:   flips (and relocation) again, in terms that suit the cloud. Where the sampling follows
///           the surface's curvature (simplified and designed models), or is random: angle^1.5 and
///           mu = 0.8.
///           Elsewhere (scans, even samplings) angles count only beyond what is usual at a place,
///           and mu = 4: nearly the Delaunay triangulation on the surface, but for sharp edges.
///           Triangles that intersect thereafter are untangled, or else the polish is taken back.
///
/// Only three moves touch the mesh - an edge is flipped whose new ends are not joined yet, a
/// triangle is split by a vertex, three triangles around a vertex are merged - and each keeps it
/// closed, manifold, oriented and of genus 0, whatever the arithmetic.
///
/// \param points    3 x n, finite, distinct; extent about 1, or such that areas are numbers.
/// \param triangles 3 x (2n - 4), over all points; closed, manifold, oriented, of genus 0.
/// \param graph     n nodes, the neighbours of each point.
/// \param options how far, seed, threads, what takes noise off, progress
/// \return the mesh: the same, bit by bit, for any number of threads.
/// \throw InvalidInput for sizes that disagree, an index or option out of range, or a mesh that is
///        not as said.
///
/// Not guaranteed: that no triangles intersect; that the energy is the least.
/// Cost: O(n log n), typically; untangling is given up after a number of attempts that is
/// proportional to n.
MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options = {});

/// @}

}  // namespace spherical_param
