#pragma once

#include "spherical_param/types.h"

#include <array>
#include <initializer_list>

namespace spherical_param::test {

inline Triangles trianglesOf(std::initializer_list<std::array<Index, 3>> list) {
  Triangles triangles(3, static_cast<Eigen::Index>(list.size()));
  Eigen::Index t = 0;
  for (const auto& triangle : list)
    triangles.col(t++) << triangle[0], triangle[1], triangle[2];
  return triangles;
}

/// Of the vertices from `first` on.
inline Triangles tetrahedron(Index first = 0) {
  Triangles triangles = trianglesOf({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  triangles.array() += first;
  return triangles;
}

}  // namespace spherical_param::test
