#include "core/sphere_mesh.h"

#include <algorithm>
#include <tuple>

namespace spherical_param::internal {

SphereMesh::SphereMesh(const Triangles& triangles, std::size_t vertex_count)
    : triangle_at_(vertex_count, -1), degree_(vertex_count, 0) {
  const auto m = static_cast<Index>(triangles.cols());
  vertices_.reserve(2 * vertex_count);
  neighbors_.reserve(2 * vertex_count);
  std::vector<std::tuple<Index, Index, Index, int>> sides;  // low, high, triangle, corner
  sides.reserve(3 * static_cast<std::size_t>(m));
  for (Index t = 0; t < m; ++t) {
    vertices_.push_back({triangles(0, t), triangles(1, t), triangles(2, t)});
    neighbors_.push_back({-1, -1, -1});
    for (int k = 0; k < 3; ++k) {
      const Index a = vertex(t, (k + 1) % 3);
      const Index b = vertex(t, (k + 2) % 3);
      sides.emplace_back(std::min(a, b), std::max(a, b), t, k);
      triangle_at_[static_cast<std::size_t>(vertex(t, k))] = t;
      ++degree_[static_cast<std::size_t>(vertex(t, k))];
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2) {
    const auto& [low, high, t, k] = sides[s];
    const auto& [other_low, other_high, other_t, other_k] = sides[s + 1];
    neighbors_[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)] = other_t;
    neighbors_[static_cast<std::size_t>(other_t)][static_cast<std::size_t>(other_k)] = t;
  }
}

int SphereMesh::cornerOf(Index triangle, Index v) const {
  const auto& corners = vertices_[static_cast<std::size_t>(triangle)];
  return static_cast<int>(std::find(corners.begin(), corners.end(), v) - corners.begin());
}

int SphereMesh::oppositeCorner(Index triangle, int corner) const {
  // The common side runs the other way round in the neighbour, from corner + 2 to corner + 1; the
  // vertex behind its end is the opposite one.
  const Index end = vertex(triangle, (corner + 1) % 3);
  return (cornerOf(neighbor(triangle, corner), end) + 1) % 3;
}

void SphereMesh::replaceNeighbor(Index triangle, Index old_neighbor, Index new_neighbor) {
  auto& around = neighbors_[static_cast<std::size_t>(triangle)];
  *std::find(around.begin(), around.end(), old_neighbor) = new_neighbor;
}

std::array<Index, 3> SphereMesh::split(Index triangle, Index new_vertex) {
  const std::array<Index, 3> v = vertices_[static_cast<std::size_t>(triangle)];
  const std::array<Index, 3> n = neighbors_[static_cast<std::size_t>(triangle)];
  const std::array<Index, 3> parts{triangle, size(), size() + 1};
  vertices_.resize(vertices_.size() + 2);
  neighbors_.resize(neighbors_.size() + 2);
  for (std::size_t k = 0; k < 3; ++k) {
    // Part k has the side opposite to corner k.
    const auto part = static_cast<std::size_t>(parts[k]);
    vertices_[part] = {new_vertex, v[(k + 1) % 3], v[(k + 2) % 3]};
    neighbors_[part] = {n[k], parts[(k + 1) % 3], parts[(k + 2) % 3]};
  }
  for (std::size_t k = 1; k < 3; ++k)
    replaceNeighbor(n[k], triangle, parts[k]);
  for (std::size_t k = 0; k < 3; ++k) {
    triangle_at_[static_cast<std::size_t>(v[k])] = parts[(k + 1) % 3];
    ++degree_[static_cast<std::size_t>(v[k])];
  }
  triangle_at_[static_cast<std::size_t>(new_vertex)] = triangle;
  degree_[static_cast<std::size_t>(new_vertex)] = 3;
  return parts;
}

bool SphereMesh::areJoined(Index v, Index w) const {
  if (degree_[static_cast<std::size_t>(w)] < degree_[static_cast<std::size_t>(v)])
    std::swap(v, w);
  const Index first = triangleAt(v);
  Index t = first;
  do {
    const int corner = cornerOf(t, v);
    if (vertex(t, (corner + 1) % 3) == w)
      return true;
    t = neighbor(t, (corner + 1) % 3);
  } while (t != first);
  return false;
}

bool SphereMesh::flip(Index triangle, int corner) {
  const Index other = neighbor(triangle, corner);
  const int other_corner = oppositeCorner(triangle, corner);
  const Index c = vertex(triangle, corner);
  const Index a = vertex(triangle, (corner + 1) % 3);
  const Index b = vertex(triangle, (corner + 2) % 3);
  const Index d = vertex(other, other_corner);
  if (c == d || areJoined(c, d))
    return false;
  const Index beyond_bc = neighbor(triangle, (corner + 1) % 3);
  const Index beyond_ca = neighbor(triangle, (corner + 2) % 3);
  const Index beyond_ad = neighbor(other, (other_corner + 1) % 3);
  const Index beyond_db = neighbor(other, (other_corner + 2) % 3);
  // (c, a, b) and (d, b, a) become (c, a, d) and (c, d, b).
  vertices_[static_cast<std::size_t>(triangle)] = {c, a, d};
  neighbors_[static_cast<std::size_t>(triangle)] = {beyond_ad, other, beyond_ca};
  vertices_[static_cast<std::size_t>(other)] = {c, d, b};
  neighbors_[static_cast<std::size_t>(other)] = {beyond_db, beyond_bc, triangle};
  replaceNeighbor(beyond_ad, other, triangle);
  replaceNeighbor(beyond_bc, triangle, other);
  triangle_at_[static_cast<std::size_t>(a)] = triangle;
  triangle_at_[static_cast<std::size_t>(b)] = other;
  triangle_at_[static_cast<std::size_t>(c)] = triangle;
  triangle_at_[static_cast<std::size_t>(d)] = triangle;
  --degree_[static_cast<std::size_t>(a)];
  --degree_[static_cast<std::size_t>(b)];
  ++degree_[static_cast<std::size_t>(c)];
  ++degree_[static_cast<std::size_t>(d)];
  return true;
}

Triangles SphereMesh::triangles() const {
  Triangles result(3, size());
  for (Index t = 0; t < size(); ++t)
    for (int k = 0; k < 3; ++k)
      result(k, t) = vertex(t, k);
  return result;
}

}  // namespace spherical_param::internal
