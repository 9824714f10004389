#include "relocation.h"

#include "optimization_constants.h"
#include "parallel.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

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

}  // namespace

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

}  // namespace spherical_param::internal
