#include "boundary_loops.h"

#include "corner_table.h"
#include "rows.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

std::vector<std::vector<Index>> boundaryLoops(const Triangles& triangles,
                                              std::size_t vertex_count) {
  const CornerTable corners(triangles, vertex_count, 1);
  const auto has_side = [&](Index v, Index w) {
    // At the end with fewer triangles: the other one may be a hub.
    const bool at_first = corners.countAt(v) <= corners.countAt(w);
    bool is_found = false;
    corners.forEachCorner(at_first ? v : w, [&](Index t, Index k) {
      is_found = is_found ||
                 triangles(at_first ? nextCorner(k) : previousCorner(k), t) == (at_first ? w : v);
    });
    return is_found;
  };
  // The vertex after each in the boundary: where an edge has no triangle on its other side.
  Indexed<Index> next(vertex_count, -1);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k)
      if (!has_side(triangles((k + 1) % 3, t), triangles(k, t)))
        next[triangles(k, t)] = triangles((k + 1) % 3, t);
  std::vector<std::vector<Index>> loops;
  for (const Index v : indicesOf(next)) {
    if (next[v] < 0)
      continue;
    loops.emplace_back();
    for (Index w = v; w >= 0; w = std::exchange(next[loops.back().back()], -1))
      loops.back().push_back(w);
    loops.back().pop_back();  // the first vertex again
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return loops;
}

}  // namespace spherical_param::internal
