#pragma once

#include "indexed.h"

#include <cstddef>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The nodes that can be reached from a source, by ascending length of the shortest path, then by
/// number (E. W. Dijkstra, 1959).
///
/// \param lengths infinite before; receives the lengths of the paths.
/// \param for_each_edge (v, go) calls go(w, length) for the edges from v, of lengths >= 0; go
///                      returns whether the path through v is the shortest to w so far.
template <typename ForEachEdge>
std::vector<Index> shortestPaths(Index source, Indexed<double>& lengths,
                                 const ForEachEdge& for_each_edge) {
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<Index> reached;
  lengths[source] = 0.0;
  queue.emplace(0.0, source);
  while (!queue.empty()) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > lengths[v])
      continue;
    reached.push_back(v);
    for_each_edge(v, [&, to_v = length](Index w, double edge) {
      const double to_w = to_v + edge;
      if (!(to_w < lengths[w]))
        return false;
      lengths[w] = to_w;
      queue.emplace(to_w, w);
      return true;
    });
  }
  return reached;
}

}  // namespace spherical_param::internal
