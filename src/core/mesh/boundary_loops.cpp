#include "boundary_loops.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace spherical_param::internal {

std::vector<std::vector<Index>> boundaryLoops(const Triangles& triangles,
                                              std::size_t vertex_count) {
  // Inside, the vertices that follow v in its triangles are those that precede it. On the boundary
  // one follows and another one precedes: their numbers do not cancel.
  std::vector<std::int64_t> balance(vertex_count, 0);
  const auto for_each_side = [&](const auto& visit) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      for (Eigen::Index k = 0; k < 3; ++k)
        visit(triangles(k, t), triangles((k + 1) % 3, t));
  };
  for_each_side([&](Index v, Index w) {
    balance[static_cast<std::size_t>(v)] += w;
    balance[static_cast<std::size_t>(w)] -= v;
  });
  const auto is_at_boundary = [&](Index v) { return balance[static_cast<std::size_t>(v)] != 0; };
  // The vertex after each in the boundary: where an edge has no triangle on its other side.
  std::vector<std::pair<Index, Index>> sides;
  for_each_side([&](Index v, Index w) {
    if (is_at_boundary(v) && is_at_boundary(w))
      sides.emplace_back(v, w);
  });
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
