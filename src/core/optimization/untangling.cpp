#include "untangling.h"

#include "optimization_constants.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

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
bool forEachPair(Workbench& bench, IntersectingPairs& found, const Work& work) {
  const SphereMesh& mesh = bench.mesh.mesh();
  const auto& pairs = found.pairs;
  std::vector<std::vector<Index>> vertices;
  vertices.reserve(pairs.size());
  for (const auto& pair : pairs)
    vertices.push_back(verticesOf(mesh, pair));
  bool has_changed = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bench.reportItem(i, pairs.size(), 1);
    const auto is_there = [&] { return verticesOf(mesh, pairs[i]) == vertices[i]; };
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

}  // namespace

IntersectingPairs untangle(Workbench& bench, IntersectingPairs found, int rounds_by_energy) {
  const auto is_due = [&] { return !found.pairs.empty() && !found.is_sample && bench.mayRepair(); };
  for (int round = 0; round < rounds_by_energy && is_due(); ++round)
    if (!rebuild(bench, false, 8 * tuned::kMinUntangled, found))
      break;
  // Rounds in a row without a gain. Small parts gain more in the same time: large ones once nothing
  // else helps.
  for (int idle = 0; idle < tuned::kMaxIdleRounds && is_due();) {
    if (idle == 0)
      flipApart(bench, found);
    if (!is_due())
      break;
    const std::size_t largest = tuned::kMinUntangled << std::min(idle + 2, 4);
    idle = rebuild(bench, true, largest, found) ? 0 : idle + 1;
  }
  return found;
}

}  // namespace spherical_param::internal
