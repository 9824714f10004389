#include "unfolding.h"

#include "optimization_constants.h"

#include <array>
#include <cstddef>
#include <vector>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

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

}  // namespace

bool unfold(Workbench& bench) {
  auto folded = foldedEdges(bench.mesh);
  for (int round = 0; round < tuned::kMaxUnfoldingRounds && !folded.empty() &&
                      bench.mayRepair(tuned::kUnfoldingDivisor);
       ++round) {
    for (std::size_t i = 0; i < folded.size(); ++i) {
      bench.reportItem(i, folded.size(), 16);
      const auto& [v, w] = folded[i];
      for (std::size_t size = tuned::kMinRuin; size <= 8 * tuned::kMinRuin; size *= 2)
        if (bench.mesh.mesh().areJoined(v, w) && bench.mayRepair(tuned::kUnfoldingDivisor))
          bench.tryPart({v, w}, size, isGain);
    }
    folded = foldedEdges(bench.mesh);
  }
  return !folded.empty();
}

}  // namespace spherical_param::internal
