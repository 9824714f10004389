#include "graph_cycles.h"

#include "cycle_labels.h"
#include "indexed.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// None if a node has more than 64 neighbours on average. At a reach of 3 there are some 40 on a
/// surface; memory and time grow with the number and its square.
std::optional<NeighborRows> powerOf(const Graph& graph, int reach) {
  NeighborRows power;
  Indexed<Index> seen_from(graph.size(), -1);
  std::vector<Index> disc;
  for (const Index center : graph.nodes()) {
    disc.assign(1, center);
    seen_from[center] = center;
    std::size_t begin = 0;
    for (int step = 0; step < reach; ++step)
      for (const std::size_t end = disc.size(); begin < end; ++begin)
        for (const Index w : graph.row(disc[begin]))
          if (std::exchange(seen_from[w], center) != center)
            disc.push_back(w);
    std::sort(disc.begin() + 1, disc.end());
    power.neighbors.insert(power.neighbors.end(), disc.begin() + 1, disc.end());
    power.endRow();
    if (power.neighbors.size() > 64 * graph.size())
      return std::nullopt;
  }
  return power;
}

}  // namespace

std::optional<int> countCycles(const Graph& graph, int reach) {
  std::optional<NeighborRows> power = powerOf(graph, reach);
  if (!power)
    return std::nullopt;
  const NumberedGraph numbered(std::move(*power));
  const CycleLabels labels(numbered, {});
  return labels.areComplete() ? std::optional(labels.rank()) : std::nullopt;
}

}  // namespace spherical_param::internal
