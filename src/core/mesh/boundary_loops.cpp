#include "boundary_loops.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

std::vector<std::vector<Index>> boundaryLoops(const Triangles& triangles,
                                              std::size_t vertex_count) {
  // The vertex after each in the boundary: where an edge has no triangle on its other side.
  std::vector<std::pair<Index, Index>> sides;
  sides.reserve(static_cast<std::size_t>(triangles.size()));
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k)
      sides.emplace_back(triangles(k, t), triangles((k + 1) % 3, t));
  std::sort(sides.begin(), sides.end());
  std::vector<Index> next(vertex_count, -1);
  for (const auto& [v, w] : sides)
    if (!std::binary_search(sides.begin(), sides.end(), std::pair(w, v)))
      next[static_cast<std::size_t>(v)] = w;
  std::vector<std::vector<Index>> loops;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (next[v] < 0)
      continue;
    loops.emplace_back();
    for (auto w = static_cast<Index>(v); w >= 0;) {
      loops.back().push_back(w);
      w = std::exchange(next[static_cast<std::size_t>(w)], -1);
    }
    loops.back().pop_back();  // the first vertex again
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return loops;
}

}  // namespace spherical_param::internal
