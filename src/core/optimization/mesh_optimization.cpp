#include "mesh_optimization.h"

#include "open_mesh.h"
#include "optimization_constants.h"
#include "polish.h"
#include "relocation.h"
#include "sampling_analysis.h"
#include "smoothing.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "unfolding.h"
#include "untangling.h"
#include "workbench.h"

#include <algorithm>
#include <utility>

namespace spherical_param {
namespace {

namespace tuned = internal::optimization_constants;
using internal::IntersectingPairs;
using internal::Workbench;

/// Open triangles that no loop leads to are part of the surface, and must not intersect it.
/// Returns whether some were closed.
bool closeWithoutLoop(Workbench& bench) {
  if (!bench.openings)
    return false;
  const internal::SphereMesh& mesh = bench.mesh.mesh();
  std::vector<Index> vertices;
  for (const Index t : internal::trianglesWithoutLoop(mesh, *bench.openings))
    vertices.insert(vertices.end(), mesh.vertices(t).begin(), mesh.vertices(t).end());
  if (!bench.openings->close(vertices))
    return false;
  bench.mesh.setPoints(bench.mesh.points());
  return true;
}

/// Untangles, again as long as that leaves open triangles without a loop.
IntersectingPairs untangleSurface(Workbench& bench, IntersectingPairs pairs, int rounds_by_energy) {
  pairs = internal::untangle(bench, std::move(pairs), rounds_by_energy);
  for (int round = 0; round < tuned::kMaxRounds && closeWithoutLoop(bench); ++round)
    pairs = internal::untangle(bench, bench.findIntersections(), rounds_by_energy);
  return pairs;
}

/// Goes back to the mesh before the polish if fewer of its triangles intersect.
void rollBackPolish(Workbench& bench, const Triangles& unpolished, IntersectingPairs& found) {
  const Triangles polished = bench.mesh.mesh().triangles();
  bench.mesh.reset(unpolished);
  IntersectingPairs before = bench.findIntersections();
  if (before.areFewerThan(found))
    found = std::move(before);
  else
    bench.mesh.reset(polished);
}

/// From the first flips to the polish, on the points of the bench. Returns the intersections.
IntersectingPairs optimize(Workbench& bench, const internal::Sampling& sampling,
                           std::vector<Index> rough) {
  const internal::SurfaceEnergy energy;
  bench.mesh.setEnergy(energy);
  internal::relocate(bench, std::move(rough));
  // Where nothing is folded, hardly anything intersects: once after the polish is enough.
  if (internal::unfold(bench)) {
    IntersectingPairs found =
        internal::untangle(bench, bench.findIntersections(), tuned::kMaxRoundsByEnergy);
    if (found.is_sample)
      return found;
  }
  const Triangles unpolished = bench.mesh.mesh().triangles();
  // Without repairs afterwards, most of what the polish moves intersects.
  const bool is_polished = bench.mayRepair();
  if (is_polished)
    internal::polish(bench, sampling);
  // With the first energy: it is what keeps sheets apart.
  bench.mesh.setEnergy(energy);
  closeWithoutLoop(bench);
  IntersectingPairs found =
      untangleSurface(bench, bench.findIntersections(), tuned::kMaxRoundsByEnergy);
  if (is_polished && !found.pairs.empty())
    rollBackPolish(bench, unpolished, found);
  return found;
}

/// After work on smoothed points: untangles on the given ones, unless too many triangles intersect
/// there. Returns the intersections.
IntersectingPairs finishOn(const Positions& points, Workbench& bench) {
  bench.mesh.setPoints(points);
  closeWithoutLoop(bench);
  // The smoothed points may have taken all the work: a few points then stayed tangled.
  bench.renewWork();
  // More pairs are slow, and in vain: without this limit 8 of 10 noisy clouds keep 9 to 122
  // intersections instead of 0. The second number matters only above 150,000 points.
  const std::size_t most = std::max<std::size_t>(1500, internal::columnCount(points) / 100);
  IntersectingPairs found = internal::findIntersections(bench.mesh, 2 * most, bench.report);
  return found.pairs.size() > most ? found : untangleSurface(bench, std::move(found), 0);
}

}  // namespace

Triangles flipMesh(const Positions& points, const Triangles& triangles, const Graph& graph,
                   const OptimizationOptions& options, const Execution& execution) {
  Workbench bench(points, triangles, graph, options, execution);
  const auto sampling = internal::analyzeSampling(points, graph, execution.threads);
  internal::flipFor(bench, sampling, tuned::kMu);
  return bench.mesh.mesh().triangles();
}

MeshOptimization optimizeMesh(const Positions& points, const Triangles& triangles,
                              const Graph& graph, const OptimizationOptions& options,
                              const Execution& execution) {
  const MeshTopology topology = checkTopology(triangles, graph.size(), execution.threads);
  if (!topology.closed || !topology.isSurface())
    throw InvalidInput("optimizeMesh: the triangles must be a closed, manifold, consistently "
                       "oriented mesh in one piece over all points");
  Workbench bench(points, triangles, graph, options, execution);
  const auto sampling = internal::analyzeSampling(points, graph, execution.threads);
  const auto flip = [&] {
    internal::flipFor(bench, sampling, tuned::kMu);
    return internal::roughVertices(bench.mesh, bench.report);
  };
  std::vector<Index> rough = flip();
  Positions smoothed;
  // Clouds of closed surfaces without noise have a fraction of rough vertices of 0.003 to 0.16, and
  // coarse ones with limbs of a few points 0.36; with noise of a quarter of the points' distance it
  // is 0.75 and more. Without smoothing, noise of half a spacing on the hand and of 1.5 on a sphere
  // leaves 72 and 141 self-intersections instead of 0. More steps where more is rough gain nothing.
  bench.log.is_noisy = 2 * rough.size() > graph.size() && !bench.isOutOfTime();
  if (bench.log.is_noisy) {
    const SmoothingOptions smoothing{SmoothingMethod::Umbrella, 3, false};
    smoothed =
        smoothSurface(points, bench.mesh.mesh().triangles(), smoothing, execution.threads).points;
    bench.mesh.setPoints(smoothed);
    rough = flip();
  }
  MeshOptimization result;
  result.intersecting = optimize(bench, sampling, std::move(rough));
  if (bench.log.is_noisy && options.finish_on_points)
    result.intersecting = finishOn(points, bench);
  result.triangles = bench.mesh.mesh().triangles();
  result.report = bench.log;
  return result;
}

}  // namespace spherical_param
