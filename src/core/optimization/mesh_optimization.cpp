#include "mesh_optimization.h"

#include "optimization_constants.h"
#include "parallel.h"
#include "sampling_analysis.h"
#include "smoothing.h"
#include "workbench.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

/// Whether the sampling is even: as the caller knows, or as it is found.
bool isEven(const Positions& points, const Graph& graph, const OptimizationOptions& options,
            const Execution& execution) {
  return options.is_even ? *options.is_even : isEvenlySampled(points, graph, execution.threads);
}

/// Flips with the energy that suits a sampling.
///
/// \param mu of a sampling that is not even.
void flipFor(Workbench& bench, bool is_even, double mu) {
  bench.mesh.setEnergy(is_even ? SurfaceEnergy::Bend::Excess : SurfaceEnergy::Bend::Power,
                       is_even ? tuned::kEvenMu : mu);
  bench.flips.flipAll(bench.report, [&] { return bench.isOverdue(); });
}

// --- Relocation ----------------------------------------------------------------------------------

/// Whether a vertex is in a ring, or joined to one of its vertices.
bool isNear(const SphereMesh& mesh, const std::vector<Index>& ring, Index w) {
  const auto is_in_ring = [&](Index u) {
    return std::find(ring.begin(), ring.end(), u) != ring.end();
  };
  return is_in_ring(w) || mesh.anyAround(w, [&](Index t, int corner) {
    return is_in_ring(mesh.vertex(t, (corner + 1) % 3));
  });
}

/// \param ring working memory
bool isRough(const EnergyMesh& of, Index v, std::vector<Index>& ring) {
  const SphereMesh& mesh = of.mesh();
  ring.clear();
  bool is_rough = false;
  double lengths = 0.0;
  mesh.forEachAround(v, [&](Index t, int corner) {
    const int k = (corner + 1) % 3;
    const Index w = mesh.vertex(t, k);
    ring.push_back(w);
    lengths += (of.points().col(v) - of.points().col(w)).norm();
    is_rough = is_rough ||
               Facet::cosine(of.facet(t), of.facet(mesh.neighbor(t, k))) < tuned::kMinSmoothCosine;
  });
  // In a graph of many neighbours, most of them are far.
  const double far = tuned::kMaxNearNeighbor * lengths / static_cast<double>(ring.size());
  const Graph& graph = of.graph();
  for (const std::size_t e : graph.entries(v))
    if (!is_rough && graph.lengths[e] <= far)
      is_rough = !isNear(mesh, ring, graph.neighbors[e]);
  return is_rough;
}

/// Rough vertices near some vertices, ascending.
std::vector<Index> roughNear(const EnergyMesh& mesh, const std::vector<Index>& vertices) {
  std::vector<Index> near;
  for (const Index v : vertices) {
    near.push_back(v);
    mesh.mesh().forEachAround(v, [&](Index t, int corner) {
      appendNeighbors(mesh, mesh.mesh().vertex(t, (corner + 1) % 3), near);
    });
  }
  sortUnique(near);
  std::vector<Index> ring;
  near.erase(
      std::remove_if(near.begin(), near.end(), [&](Index v) { return !isRough(mesh, v, ring); }),
      near.end());
  return near;
}

/// All vertices with a sharp edge, or more than two edges away from a near neighbour in the graph,
/// ascending.
std::vector<Index> roughVertices(const EnergyMesh& mesh, const FractionReport& report = {}) {
  return collectBlocks<Index>(columnCount(mesh.points()), mesh.threads(), report,
                              [&](Index begin, Index end, std::vector<Index>& rough) {
                                std::vector<Index> ring;
                                for (Index v = begin; v < end; ++v)
                                  if (isRough(mesh, v, ring))
                                    rough.push_back(v);
                              });
}

/// Puts rough vertices where they cost least, and then rough ones near those that moved, in some
/// rounds.
void relocate(Workbench& bench, std::vector<Index> rough) {
  std::size_t left = columnCount(bench.mesh.points());
  for (int round = 0; round < tuned::kMaxRounds && !rough.empty() && !bench.isOutOfTime();
       ++round) {
    rough.resize(std::min(rough.size(), left));
    left -= rough.size();
    std::vector<Index> moved;
    for (std::size_t i = 0; i < rough.size() && !bench.isOutOfTime(); ++i) {
      bench.reportItem(i, rough.size(), 256);
      if (bench.ruins.recreate({rough[i]}, isGain))
        moved.push_back(rough[i]);
    }
    // Only vertices near those that moved may have become rough.
    rough = roughNear(bench.mesh, moved);
  }
}

// --- Unfolding -----------------------------------------------------------------------------------

/// The two vertices of each folded edge.
std::vector<std::array<Index, 2>> foldedEdges(const EnergyMesh& of) {
  const SphereMesh& mesh = of.mesh();
  std::vector<std::array<Index, 2>> edges;
  for (Index t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index o = mesh.neighbor(t, k);
      if (t < o && Facet::cosine(of.facet(t), of.facet(o)) < tuned::kMinUnfoldedCosine)
        edges.push_back(mesh.side(t, k));
    }
  return edges;
}

/// Ruins and recreates parts around folded edges. Returns whether some are left.
bool unfold(Workbench& bench) {
  auto folded = foldedEdges(bench.mesh);
  for (int round = 0; round < tuned::kMaxUnfoldingRounds && !folded.empty() &&
                      bench.mayRepair(tuned::kUnfoldingWork);
       ++round) {
    for (std::size_t i = 0; i < folded.size(); ++i) {
      bench.reportItem(i, folded.size(), 16);
      const auto& [v, w] = folded[i];
      for (std::size_t size = tuned::kMinRuin; size <= 8 * tuned::kMinRuin; size *= 2)
        if (bench.mesh.mesh().areJoined(v, w) && bench.mayRepair(tuned::kUnfoldingWork))
          bench.tryPart({v, w}, size, isGain);
    }
    folded = foldedEdges(bench.mesh);
  }
  return !folded.empty();
}

// --- Untangling ----------------------------------------------------------------------------------

/// Ruins and recreates a part, and flips apart what intersects then. Commits if fewer pairs of
/// triangles around it intersect, or as many after a change that lowered the energy before the
/// flips. Returns whether it committed.
bool tryByNumber(Workbench& bench, const std::vector<Index>& seeds, std::size_t size) {
  if (!bench.mayRepair())
    return false;
  bench.local.watch(bench.ruins.spread(seeds, 2 * size + tuned::kWatchedVertices));
  return bench.tryPart(seeds, size, [&](double change) {
    const int more = bench.local.flipChangedApart();
    return more < 0 || (more == 0 && isGain(change));
  });
}

/// Calls work(vertices, is_there) for all intersecting pairs, where is_there() returns whether the
/// triangles have not changed since. It returns whether it has changed the mesh. Updates the pairs;
/// returns whether the mesh has changed.
template <typename Work>
bool forEachPair(Workbench& bench, IntersectingPairs& found, const Work& work) {
  const SphereMesh& mesh = bench.mesh.mesh();
  const auto& pairs = found.pairs;
  std::vector<std::vector<Index>> vertices;
  vertices.reserve(pairs.size());
  for (const auto& pair : pairs)
    vertices.push_back(mesh.verticesOf(pair));
  bool has_changed = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bench.reportItem(i, pairs.size(), 1);
    const auto is_there = [&] { return mesh.verticesOf(pairs[i]) == vertices[i]; };
    has_changed = work(vertices[i], is_there) || has_changed;
  }
  if (has_changed)
    found = bench.findIntersections();
  return has_changed;
}

/// Flips near intersecting triangles, and rebuilds small parts there: flips alone may leave the
/// surface crumpled. Without those parts, a cube of 8 points keeps a corner cut off.
void flipApart(Workbench& bench, IntersectingPairs& pairs) {
  forEachPair(bench, pairs, [&](const auto& seeds, const auto& is_there) {
    if (!bench.mayRepair() || !is_there())
      return false;
    bench.local.watch(bench.ruins.spread(seeds, tuned::kFlipRegion));
    if (bench.local.flipApart() == 0)
      return false;
    for (std::size_t size = tuned::kMinUntangled; size <= 4 * tuned::kMinUntangled; size *= 2)
      tryByNumber(bench, seeds, size);
    return true;
  });
}

/// A round with parts up to a size. Returns whether one of them was committed.
bool rebuild(Workbench& bench, bool is_by_number, std::size_t largest, IntersectingPairs& pairs) {
  return forEachPair(bench, pairs, [&](const auto& seeds, const auto& is_there) {
    bool has_changed = false;
    // A pair that has changed waits for the next round.
    for (std::size_t size = tuned::kMinUntangled; size <= largest && is_there(); size *= 2)
      if (is_by_number ? tryByNumber(bench, seeds, size) : bench.tryPart(seeds, size, isGain))
        has_changed = true;
    return has_changed;
  });
}

/// Ruins and recreates parts around intersecting triangles, in rounds: some by energy, then by the
/// number of intersections, with larger parts once small ones no longer help.
///
/// \param found pairs of triangles that intersect; a sample is left alone.
/// \param rounds_by_energy number of the first rounds.
/// \return the pairs that are left.
IntersectingPairs untangle(Workbench& bench, IntersectingPairs found, int rounds_by_energy) {
  const auto is_due = [&] { return !found.pairs.empty() && !found.is_sample && bench.mayRepair(); };
  for (int round = 0; round < rounds_by_energy && is_due(); ++round)
    if (!rebuild(bench, false, 8 * tuned::kMinUntangled, found))
      break;
  // Rounds in a row without a gain. Small parts gain more in the same time: large ones once nothing
  // else helps.
  for (int round = 0, idle = 0;
       round < tuned::kMaxRoundsByNumber && idle < tuned::kMaxIdleRounds && is_due(); ++round) {
    if (idle == 0)
      flipApart(bench, found);
    if (!is_due())
      break;
    const std::size_t largest = tuned::kMinUntangled << std::min(idle + 2, 4);
    idle = rebuild(bench, true, largest, found) ? 0 : idle + 1;
  }
  return found;
}

// --- From the first flips to the polish ----------------------------------------------------------

/// Closes the open triangles that others do not connect to a loop: they are part of the surface,
/// and must not intersect it. Returns whether there were any.
bool closeWithoutLoop(Workbench& bench) {
  if (!bench.openings)
    return false;
  const SphereMesh& mesh = bench.mesh.mesh();
  if (!bench.openings->close(mesh.verticesOf(trianglesWithoutLoop(mesh, *bench.openings))))
    return false;
  bench.mesh.setPoints(bench.mesh.points());
  return true;
}

/// Untangles, again as long as that leaves open triangles without a loop.
IntersectingPairs untangleSurface(Workbench& bench, IntersectingPairs pairs, int rounds_by_energy) {
  pairs = untangle(bench, std::move(pairs), rounds_by_energy);
  for (int round = 0; round < tuned::kMaxRounds && closeWithoutLoop(bench); ++round)
    pairs = untangle(bench, bench.findIntersections(), rounds_by_energy);
  return pairs;
}

/// Goes back to the mesh before the polish if fewer of its triangles intersect.
void rollBackPolish(Workbench& bench, SphereMesh unpolished, IntersectingPairs& found) {
  SphereMesh polished = bench.mesh.mesh();
  bench.mesh.reset(std::move(unpolished));
  IntersectingPairs before = bench.findIntersections();
  if (before.areFewerThan(found))
    found = std::move(before);
  else
    bench.mesh.reset(std::move(polished));
}

/// From the first flips to the polish, on the points of the bench. Returns the intersections.
IntersectingPairs optimize(Workbench& bench, bool is_even, std::vector<Index> rough) {
  bench.mesh.setEnergy();
  relocate(bench, std::move(rough));
  // Where nothing is folded, hardly anything intersects: once after the polish is enough.
  if (unfold(bench)) {
    IntersectingPairs found = untangle(bench, bench.findIntersections(), tuned::kMaxRoundsByEnergy);
    if (found.is_sample)
      return found;
  }
  SphereMesh unpolished = bench.mesh.mesh();
  // Without repairs afterwards, most of what the polish moves intersects.
  const bool is_polished = bench.mayRepair();
  if (is_polished) {
    flipFor(bench, is_even, tuned::kPolishMu);
    if (!is_even)
      relocate(bench, roughVertices(bench.mesh));
  }
  // With the first energy: it is what keeps sheets apart.
  bench.mesh.setEnergy();
  closeWithoutLoop(bench);
  IntersectingPairs found =
      untangleSurface(bench, bench.findIntersections(), tuned::kMaxRoundsByEnergy);
  if (is_polished && !found.pairs.empty())
    rollBackPolish(bench, std::move(unpolished), found);
  return found;
}

/// After work on smoothed points: untangles on the given ones, unless too many triangles intersect
/// there. Returns the intersections.
IntersectingPairs finishOn(const Positions& points, Workbench& bench) {
  bench.mesh.setPoints(points);
  closeWithoutLoop(bench);
  // The smoothed points may have taken all the work.
  bench.renewWork();
  // With more pairs the work is in vain. The second number matters only above 150,000 points.
  const std::size_t most = std::max<std::size_t>(1500, columnCount(points) / 100);
  IntersectingPairs found = findIntersections(bench.mesh, 2 * most, bench.report);
  return found.pairs.size() > most ? found : untangleSurface(bench, std::move(found), 0);
}

}  // namespace

SphereMesh flipMesh(const Positions& points, SphereMesh mesh, const Graph& graph,
                    const OptimizationOptions& options, const Execution& execution) {
  Workbench bench(points, std::move(mesh), graph, options, execution);
  flipFor(bench, isEven(points, graph, options, execution), tuned::kMu);
  return bench.mesh.mesh();
}

MeshOptimization optimizeMesh(const Positions& points, SphereMesh mesh, const Graph& graph,
                              const OptimizationOptions& options, const Execution& execution) {
  Workbench bench(points, std::move(mesh), graph, options, execution);
  const bool is_even = isEven(points, graph, options, execution);
  const auto flip = [&] {
    flipFor(bench, is_even, tuned::kMu);
    return roughVertices(bench.mesh, bench.report);
  };
  std::vector<Index> rough = flip();
  Positions smoothed;
  // Without noise, the fraction of rough vertices is at most 0.36, in coarse clouds with limbs of a
  // few points; with noise of a quarter of the points' distance it is at least 0.75. Without
  // smoothing, noise leaves self-intersections. More steps gain nothing.
  bench.log.is_noisy = 2 * rough.size() > graph.size() && !bench.isOutOfTime();
  if (bench.log.is_noisy) {
    const SmoothingOptions smoothing{SmoothingMethod::Umbrella, 3, false};
    smoothed =
        smoothSurface(points, bench.mesh.mesh().triangles(), smoothing, execution.threads).points;
    bench.mesh.setPoints(smoothed);
    rough = flip();
  }
  MeshOptimization result;
  result.intersecting = optimize(bench, is_even, std::move(rough));
  if (bench.log.is_noisy && options.finish_on_points)
    result.intersecting = finishOn(points, bench);
  result.mesh = bench.mesh.mesh();
  result.report = bench.log;
  return result;
}

}  // namespace spherical_param::internal
