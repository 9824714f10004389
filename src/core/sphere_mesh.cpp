#include "core/sphere_mesh.h"

#include <algorithm>
#include <cstdint>

namespace spherical_param::internal {

SphereMesh::SphereMesh(const Triangles& triangles, std::size_t vertex_count)
    : triangle_at_(vertex_count, -1), degree_(vertex_count, 0),
      triangle_count_(static_cast<Index>(triangles.cols())) {
  const auto m = static_cast<std::size_t>(triangles.cols());
  // Room for all splits: entries must not move while changes are recorded.
  vertices_.reserve(std::max(m, 2 * vertex_count));
  neighbors_.reserve(std::max(m, 2 * vertex_count));
  std::vector<std::size_t> offsets(vertex_count + 1, 0);
  for (std::size_t t = 0; t < m; ++t) {
    const auto column = static_cast<Eigen::Index>(t);
    vertices_.push_back({triangles(0, column), triangles(1, column), triangles(2, column)});
    for (const Index v : vertices_.back()) {
      ++degree_[static_cast<std::size_t>(v)];
      triangle_at_[static_cast<std::size_t>(v)] = static_cast<Index>(t);
      ++offsets[static_cast<std::size_t>(v) + 1];
    }
  }
  neighbors_.assign(m, {-1, -1, -1});
  // Each vertex has one side that begins at it in each of its triangles; the other triangle at a
  // side begins it at its end.
  for (std::size_t v = 0; v < vertex_count; ++v)
    offsets[v + 1] += offsets[v];
  struct Side {
    Index end;
    Index triangle;
    std::uint8_t corner;
  };
  std::vector<Side> sides(3 * m);
  std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t t = 0; t < m; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      sides[next[static_cast<std::size_t>(vertices_[t][(k + 1) % 3])]++] = {
          vertices_[t][(k + 2) % 3], static_cast<Index>(t), static_cast<std::uint8_t>(k)};
  for (std::size_t v = 0; v < vertex_count; ++v)
    for (std::size_t s = offsets[v]; s < offsets[v + 1]; ++s) {
      const Side& side = sides[s];
      const auto end = static_cast<std::size_t>(side.end);
      // From the vertex of more triangles, so that the search is among the fewer.
      if (std::pair(degree_[v], v) < std::pair(degree_[end], end))
        continue;
      std::size_t twin = offsets[end];
      while (twin < offsets[end + 1] && sides[twin].end != static_cast<Index>(v))
        ++twin;
      if (twin == offsets[end + 1])
        continue;
      neighbors_[static_cast<std::size_t>(side.triangle)][side.corner] = sides[twin].triangle;
      neighbors_[static_cast<std::size_t>(sides[twin].triangle)][sides[twin].corner] =
          side.triangle;
    }
}

bool SphereMesh::isSphere() const {
  const auto m = vertices_.size();
  const auto n = triangle_at_.size();
  if (n < 4 || m != 2 * n - 4)
    return false;
  for (Index t = 0; t < size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index other = neighbor(t, k);
      if (other < 0 || other == t || vertex(t, k) == vertex(t, (k + 1) % 3))
        return false;
      // The other triangle has this one at the same side, the other way round.
      const Index from = vertex(t, (k + 1) % 3);
      const int l = (cornerOf(other, from) + 1) % 3;
      if (neighbor(other, l) != t || vertex(other, (l + 2) % 3) != from ||
          vertex(other, (l + 1) % 3) != vertex(t, (k + 2) % 3))
        return false;
    }
  // Now every walk around a vertex closes: is it through all of its triangles?
  for (std::size_t v = 0; v < n; ++v) {
    const auto i = static_cast<Index>(v);
    if (triangleAt(i) < 0)
      return false;
    Index count = 0;
    forEachAround(i, [&](Index, int) { ++count; });
    if (count != degree(i))
      return false;
  }
  // One piece, so that 2n - 4 triangles make it a sphere.
  std::vector<bool> seen(m, false);
  std::vector<Index> pending{0};
  seen[0] = true;
  std::size_t reached = 0;
  while (!pending.empty()) {
    const Index t = pending.back();
    pending.pop_back();
    ++reached;
    for (int k = 0; k < 3; ++k) {
      const auto other = static_cast<std::size_t>(neighbor(t, k));
      if (seen[other])
        continue;
      seen[other] = true;
      pending.push_back(static_cast<Index>(other));
    }
  }
  return reached == m;
}

Index SphereMesh::takePlace() {
  set(triangle_count_, triangle_count_ + 1);
  if (free_ < 0) {
    vertices_.push_back({-1, -1, -1});
    neighbors_.push_back({-1, -1, -1});
    return size() - 1;
  }
  const Index place = free_;
  set(free_, vertex(place, 1));
  return place;
}

void SphereMesh::freePlace(Index t) {
  set(triangle_count_, triangle_count_ - 1);
  setTriangle(t, {-1, free_, -1}, {-1, -1, -1});
  set(free_, t);
}

std::array<Index, 3> SphereMesh::split(Index triangle, Index new_vertex) {
  const std::array<Index, 3> v = vertices_[static_cast<std::size_t>(triangle)];
  const std::array<Index, 3> n = neighbors_[static_cast<std::size_t>(triangle)];
  const std::array<Index, 3> parts{triangle, takePlace(), takePlace()};
  for (std::size_t k = 0; k < 3; ++k)
    // Part k has the side opposite to corner k.
    setTriangle(parts[k], {new_vertex, v[(k + 1) % 3], v[(k + 2) % 3]},
                {n[k], parts[(k + 1) % 3], parts[(k + 2) % 3]});
  for (std::size_t k = 1; k < 3; ++k)
    replaceNeighbor(n[k], triangle, parts[k]);
  for (std::size_t k = 0; k < 3; ++k) {
    setTriangleAt(v[k], parts[(k + 1) % 3]);
    addDegree(v[k], 1);
  }
  setTriangleAt(new_vertex, triangle);
  set(degree_[static_cast<std::size_t>(new_vertex)], 3);
  return parts;
}

Index SphereMesh::merge(Index v) {
  if (triangle_count_ <= 4 || degree(v) != 3)
    return -1;
  std::array<Index, 3> around{};
  std::array<Index, 3> ring{};
  std::array<Index, 3> beyond{};
  std::size_t count = 0;
  forEachAround(v, [&](Index t, int corner) {
    around[count] = t;
    // Triangle k of the fan has ring vertices k and k + 1.
    ring[count] = vertex(t, (corner + 1) % 3);
    beyond[count] = neighbor(t, corner);
    ++count;
  });
  const Index t = around[0];
  // The side from ring k to ring k + 1 is opposite to ring k + 2.
  setTriangle(t, ring, {beyond[1], beyond[2], beyond[0]});
  for (std::size_t k = 1; k < 3; ++k)
    replaceNeighbor(beyond[k], around[k], t);
  for (const Index w : ring) {
    setTriangleAt(w, t);
    addDegree(w, -1);
  }
  setTriangleAt(v, -1);
  set(degree_[static_cast<std::size_t>(v)], 0);
  freePlace(around[1]);
  freePlace(around[2]);
  return t;
}

bool SphereMesh::areJoined(Index v, Index w) const {
  if (degree(w) < degree(v))
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
  setTriangle(triangle, {c, a, d}, {beyond_ad, other, beyond_ca});
  setTriangle(other, {c, d, b}, {beyond_db, beyond_bc, triangle});
  replaceNeighbor(beyond_ad, other, triangle);
  replaceNeighbor(beyond_bc, triangle, other);
  setTriangleAt(a, triangle);
  setTriangleAt(b, other);
  setTriangleAt(c, triangle);
  setTriangleAt(d, triangle);
  addDegree(a, -1);
  addDegree(b, -1);
  addDegree(c, 1);
  addDegree(d, 1);
  return true;
}

void SphereMesh::takeBack() {
  for (auto change = changes_.rbegin(); change != changes_.rend(); ++change)
    *change->first = change->second;
  keep();
}

Triangles SphereMesh::triangles() const {
  Triangles result(3, triangle_count_);
  Eigen::Index column = 0;
  for (Index t = 0; t < size(); ++t) {
    if (!isTriangle(t))
      continue;
    for (int k = 0; k < 3; ++k)
      result(k, column) = vertex(t, k);
    ++column;
  }
  return result;
}

}  // namespace spherical_param::internal
