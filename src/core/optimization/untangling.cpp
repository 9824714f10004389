#include "untangling.h"

#include "mesh_intersections.h"
#include "optimization_constants.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;
using Pairs = std::vector<std::array<Index, 2>>;

std::vector<Index> verticesOf(const SphereMesh& mesh, const std::array<Index, 2>& pair) {
  std::vector<Index> vertices;
  for (const Index t : pair)
    vertices.insert(vertices.end(), mesh.vertices(t).begin(), mesh.vertices(t).end());
  return vertices;
}

/// Ruins and recreates a part, and flips apart what intersects then: commits that if fewer
/// triangles around it intersect, or as many at an energy that was lower before the flips.
void tryByNumber(Workbench& bench, const std::vector<Index>& seeds, std::size_t size,
                 OptimizationPhase& phase) {
  if (!bench.mayRepair())
    return;
  bench.local.watch(bench.ruins.spread(seeds, 2 * size + tuned::kWatchedVertices));
  const auto accept = [&](double change) {
    const int more = bench.local.flipChangedApart();
    return more < 0 || (more == 0 && isGain(change));
  };
  bench.tryPart(seeds, size, accept, phase);
}

/// One phase: calls work(vertices, is_there, phase) for all intersecting pairs, where is_there()
/// returns whether the triangles have not changed since. Updates the pairs.
template <typename Work>
std::size_t forEachPair(Workbench& bench, const char* name, Pairs& pairs, const Work& work) {
  const SphereMesh& mesh = bench.mesh.mesh();
  std::vector<std::vector<Index>> vertices;
  for (const auto& pair : pairs)
    vertices.push_back(verticesOf(mesh, pair));
  OptimizationPhase& phase = bench.begin(name);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bench.reportItem(i, pairs.size(), 1);
    work(
        vertices[i], [&] { return verticesOf(mesh, pairs[i]) == vertices[i]; }, phase);
  }
  if (phase.moves > 0)
    pairs = findIntersections(bench.mesh, bench.report);
  return phase.moves;
}

/// Flips near intersecting triangles, and rebuilds small parts there: flips alone may leave the
/// surface crumpled. Without those parts, a cube of 8 points keeps a corner cut off.
void flipApart(Workbench& bench, Pairs& pairs) {
  forEachPair(bench, "flip apart", pairs,
              [&](const auto& seeds, const auto& is_there, OptimizationPhase& phase) {
                if (!bench.mayRepair() || !is_there())
                  return;
                bench.local.watch(bench.ruins.spread(seeds, tuned::kFlipRegion));
                ++phase.tried;
                if (bench.local.flipApart() == 0)
                  return;
                ++phase.moves;
                OptimizationPhase parts;
                for (std::size_t size = tuned::kMinUntangled; size <= 4 * tuned::kMinUntangled;
                     size *= 2)
                  tryByNumber(bench, seeds, size, parts);
              });
}

/// A round with parts up to a size. Returns the number of parts that were committed.
std::size_t rebuild(Workbench& bench, bool is_by_number, std::size_t largest, Pairs& pairs) {
  return forEachPair(bench, "untangle", pairs,
                     [&](const auto& seeds, const auto& is_there, OptimizationPhase& phase) {
                       // A pair that has changed waits for the next round.
                       for (std::size_t size = tuned::kMinUntangled; size <= largest && is_there();
                            size *= 2)
                         if (is_by_number)
                           tryByNumber(bench, seeds, size, phase);
                         else
                           bench.tryPart(seeds, size, isGain, phase);
                     });
}

}  // namespace

Pairs untangle(Workbench& bench, Pairs pairs, int rounds_by_energy) {
  const auto is_due = [&] { return !pairs.empty() && bench.mayRepair(); };
  for (int round = 0; round < rounds_by_energy && is_due(); ++round)
    if (rebuild(bench, false, tuned::kMaxUntangled / 2, pairs) == 0)
      break;
  // Rounds in a row without a gain. Small parts gain more in the same time: large ones once nothing
  // else helps.
  for (int idle = 0; idle < tuned::kMaxIdleRounds && is_due();) {
    if (idle == 0)
      flipApart(bench, pairs);
    if (!is_due())
      break;
    const std::size_t largest = std::min(tuned::kMaxUntangled, 4 * tuned::kMinUntangled << idle);
    idle = rebuild(bench, true, largest, pairs) == 0 ? idle + 1 : 0;
  }
  return pairs;
}

}  // namespace spherical_param::internal
