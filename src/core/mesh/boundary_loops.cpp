#include "boundary_loops.h"

#include "corner_table.h"
#include "rows.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

std::vector<std::vector<Index>> boundaryLoops(const Triangles& triangles, std::size_t vertex_count,
                                              int threads) {
  threads = threadCount(threads, vertex_count);
  const CornerTable corners(triangles, vertex_count, threads);
  // The next vertex on the boundary: across an edge that has no triangle on its other side.
  Indexed<Index> next(vertex_count, -1);
  using Vertices = std::vector<Index>;
  forEachIndex<Vertices>(vertex_count, threads, {}, [&](Vertices& before, Index v) {
    before.clear();
    corners.forEachCorner(
        v, [&](Index t, Index k) { before.push_back(triangles(previousCorner(k), t)); });
    std::sort(before.begin(), before.end());
    corners.forEachCorner(v, [&](Index t, Index k) {
      const Index after = triangles(nextCorner(k), t);
      if (!std::binary_search(before.begin(), before.end(), after))
        next[v] = after;
    });
  });
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
