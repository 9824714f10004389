#include "phases.h"

#include "optimization_constants.h"
#include "parallel.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;
using Pairs = std::vector<std::array<Index, 2>>;

bool isEven(const Sampling& sampling) {
  return sampling.alignment < tuned::kMaxUnalignedSampling &&
         sampling.unevenness < tuned::kMaxEvenSampling;
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
      mesh.appendNeighbors(mesh.mesh().vertex(t, (corner + 1) % 3), near);
    });
  }
  sortUnique(near);
  std::vector<Index> ring;
  near.erase(
      std::remove_if(near.begin(), near.end(), [&](Index v) { return !isRough(mesh, v, ring); }),
      near.end());
  return near;
}

// --- Unfolding and untangling --------------------------------------------------------------------

/// The two vertices of each folded edge.
std::vector<std::array<Index, 2>> foldedEdges(const EnergyMesh& of) {
  const SphereMesh& mesh = of.mesh();
  std::vector<std::array<Index, 2>> edges;
  for (Index t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index o = mesh.neighbor(t, k);
      if (t < o && Facet::cosine(of.facet(t), of.facet(o)) < tuned::kMinUnfoldedCosine)
        edges.push_back({mesh.vertex(t, (k + 1) % 3), mesh.vertex(t, (k + 2) % 3)});
    }
  return edges;
}

std::vector<Index> verticesOf(const SphereMesh& mesh, const std::array<Index, 2>& pair) {
  std::vector<Index> vertices;
  for (const Index t : pair)
    vertices.insert(vertices.end(), mesh.vertices(t).begin(), mesh.vertices(t).end());
  return vertices;
}

/// Ruins and recreates a part, and flips apart what intersects then: commits that if fewer
/// triangles around it intersect, or as many at an energy that was lower before the flips. Returns
/// whether it did.
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
bool forEachPair(Workbench& bench, Pairs& pairs, const Work& work) {
  const SphereMesh& mesh = bench.mesh.mesh();
  std::vector<std::vector<Index>> vertices;
  for (const auto& pair : pairs)
    vertices.push_back(verticesOf(mesh, pair));
  bool has_changed = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bench.reportItem(i, pairs.size(), 1);
    const auto is_there = [&] { return verticesOf(mesh, pairs[i]) == vertices[i]; };
    has_changed = work(vertices[i], is_there) || has_changed;
  }
  if (has_changed)
    pairs = findIntersections(bench.mesh, bench.report);
  return has_changed;
}

/// Flips near intersecting triangles, and rebuilds small parts there: flips alone may leave the
/// surface crumpled. Without those parts, a cube of 8 points keeps a corner cut off.
void flipApart(Workbench& bench, Pairs& pairs) {
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
bool rebuild(Workbench& bench, bool is_by_number, std::size_t largest, Pairs& pairs) {
  return forEachPair(bench, pairs, [&](const auto& seeds, const auto& is_there) {
    bool has_changed = false;
    // A pair that has changed waits for the next round.
    for (std::size_t size = tuned::kMinUntangled; size <= largest && is_there(); size *= 2)
      if (is_by_number ? tryByNumber(bench, seeds, size) : bench.tryPart(seeds, size, isGain))
        has_changed = true;
    return has_changed;
  });
}

}  // namespace

void flipFor(Workbench& bench, const Sampling& sampling, double mu) {
  SurfaceEnergy energy;
  energy.bend = isEven(sampling) ? SurfaceEnergy::Bend::Excess : SurfaceEnergy::Bend::Power;
  energy.mu = isEven(sampling) ? tuned::kEvenMu : mu;
  bench.mesh.setEnergy(energy);
  bench.flips.flipAll(bench.report);
}

std::vector<Index> roughVertices(const EnergyMesh& mesh, const FractionReport& report) {
  return collectBlocks<Index>(columnCount(mesh.points()), mesh.threads(), report,
                              [&](Index begin, Index end, std::vector<Index>& rough) {
                                std::vector<Index> ring;
                                for (Index v = begin; v < end; ++v)
                                  if (isRough(mesh, v, ring))
                                    rough.push_back(v);
                              });
}

void relocate(Workbench& bench, std::vector<Index> rough) {
  for (int round = 0; round < tuned::kMaxRounds && !rough.empty() && !bench.isOutOfTime();
       ++round) {
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

bool unfold(Workbench& bench) {
  auto folded = foldedEdges(bench.mesh);
  for (int round = 0; round < tuned::kMaxUnfoldingRounds && !folded.empty() && bench.mayRepair();
       ++round) {
    for (std::size_t i = 0; i < folded.size(); ++i) {
      bench.reportItem(i, folded.size(), 16);
      const auto& [v, w] = folded[i];
      for (std::size_t size = tuned::kMinRuin; size <= 8 * tuned::kMinRuin; size *= 2)
        if (bench.mesh.mesh().areJoined(v, w))
          bench.tryPart({v, w}, size, isGain);
    }
    folded = foldedEdges(bench.mesh);
  }
  return !folded.empty();
}

Pairs untangle(Workbench& bench, Pairs pairs, int rounds_by_energy) {
  const auto is_due = [&] { return !pairs.empty() && bench.mayRepair(); };
  for (int round = 0; round < rounds_by_energy && is_due(); ++round)
    if (!rebuild(bench, false, 8 * tuned::kMinUntangled, pairs))
      break;
  // Rounds in a row without a gain. Small parts gain more in the same time: large ones once nothing
  // else helps.
  for (int idle = 0; idle < tuned::kMaxIdleRounds && is_due();) {
    if (idle == 0)
      flipApart(bench, pairs);
    if (!is_due())
      break;
    const std::size_t largest = tuned::kMinUntangled << std::min(idle + 2, 4);
    idle = rebuild(bench, true, largest, pairs) ? 0 : idle + 1;
  }
  return pairs;
}

void polish(Workbench& bench, const Sampling& sampling) {
  flipFor(bench, sampling, tuned::kPolishMu);
  if (!isEven(sampling))
    relocate(bench, roughVertices(bench.mesh));
}

}  // namespace spherical_param::internal
