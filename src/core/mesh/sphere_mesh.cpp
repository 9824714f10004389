#include "sphere_mesh.h"

#include "corner_table.h"
#include "rows.h"

#include <algorithm>

namespace spherical_param::internal {

SphereMesh::SphereMesh(const Triangles& triangles, std::size_t vertex_count, int threads)
    : triangle_at_(vertex_count, -1), degree_(vertex_count, 0),
      triangle_count_(static_cast<Index>(triangles.cols())) {
  // Room for all splits: entries must not move while changes are recorded.
  const auto m = columnCount(triangles);
  vertices_.reserve(std::max(m, 2 * vertex_count));
  neighbors_.reserve(std::max(m, 2 * vertex_count));
  vertices_.resize(m);
  neighbors_.resize(m);
  threads = threadCount(threads, m);
  forEachIndex(m, threads, {}, [&](Index t) {
    vertices_[t] = {triangles(0, t), triangles(1, t), triangles(2, t)};
  });
  // Around a vertex, the next triangle after t ends where t begins.
  const CornerTable corners(triangles, vertex_count, threads);
  std::vector<Indexed<Index>> ending_of(static_cast<std::size_t>(threads),
                                        Indexed<Index>(vertex_count));
  forEachIndex(vertex_count, threads, {}, [&](Index v) {
    Indexed<Index>& ending_at = ending_of[threadNumber()];
    corners.forEachCorner(
        v, [&](Index t, Index k) { ending_at[triangles(previousCorner(k), t)] = t; });
    corners.forEachCorner(v, [&](Index t, Index k) {
      neighbors_[t][static_cast<std::size_t>(previousCorner(k))] =
          ending_at[triangles(nextCorner(k), t)];
      triangle_at_[v] = t;
    });
    degree_[v] = static_cast<Index>(corners.countAt(v));
  });
}

Index SphereMesh::takePlace() {
  journal_.set(triangle_count_, triangle_count_ + 1);
  if (free_ < 0) {
    vertices_.push_back({-1, -1, -1});
    neighbors_.push_back({-1, -1, -1});
    return size() - 1;
  }
  const Index place = free_;
  journal_.set(free_, vertex(place, 1));
  return place;
}

void SphereMesh::freePlace(Index t) {
  journal_.set(triangle_count_, triangle_count_ - 1);
  setTriangle(t, {-1, free_, -1}, {-1, -1, -1});
  journal_.set(free_, t);
}

std::array<Index, 3> SphereMesh::split(Index triangle, Index new_vertex) {
  const std::array<Index, 3> v = vertices_[triangle];
  const std::array<Index, 3> n = neighbors_[triangle];
  const std::array<Index, 3> parts{triangle, takePlace(), takePlace()};
  for (std::size_t k = 0; k < 3; ++k)
    // Part k has the side opposite to corner k.
    setTriangle(parts[k], {new_vertex, v[(k + 1) % 3], v[(k + 2) % 3]},
                {n[k], parts[(k + 1) % 3], parts[(k + 2) % 3]});
  for (std::size_t k = 1; k < 3; ++k)
    replaceNeighbor(n[k], triangle, parts[k]);
  for (std::size_t k = 0; k < 3; ++k) {
    journal_.set(triangle_at_[v[k]], parts[(k + 1) % 3]);
    addDegree(v[k], 1);
  }
  journal_.set(triangle_at_[new_vertex], triangle);
  journal_.set(degree_[new_vertex], 3);
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
    journal_.set(triangle_at_[w], t);
    addDegree(w, -1);
  }
  journal_.set(triangle_at_[v], -1);
  journal_.set(degree_[v], 0);
  freePlace(around[1]);
  freePlace(around[2]);
  return t;
}

bool SphereMesh::areJoined(Index v, Index w) const {
  if (degree(w) < degree(v))
    std::swap(v, w);
  return anyAround(v, [&](Index t, int corner) { return vertex(t, (corner + 1) % 3) == w; });
}

bool SphereMesh::flip(Index triangle, int corner) {
  const bool is_free = isFree(*this, diamond(triangle, corner));
  if (is_free)
    flipFree(triangle, corner);
  return is_free;
}

void SphereMesh::flipFree(Index triangle, int corner) {
  const Index other = neighbor(triangle, corner);
  const int other_corner = oppositeCorner(triangle, corner);
  const auto [a, b, c, d] = diamond(triangle, corner);
  const Index beyond_bc = neighbor(triangle, (corner + 1) % 3);
  const Index beyond_ca = neighbor(triangle, (corner + 2) % 3);
  const Index beyond_ad = neighbor(other, (other_corner + 1) % 3);
  const Index beyond_db = neighbor(other, (other_corner + 2) % 3);
  // (c, a, b) and (d, b, a) become (c, a, d) and (c, d, b).
  setTriangle(triangle, {c, a, d}, {beyond_ad, other, beyond_ca});
  setTriangle(other, {c, d, b}, {beyond_db, beyond_bc, triangle});
  replaceNeighbor(beyond_ad, other, triangle);
  replaceNeighbor(beyond_bc, triangle, other);
  journal_.set(triangle_at_[a], triangle);
  journal_.set(triangle_at_[b], other);
  journal_.set(triangle_at_[c], triangle);
  journal_.set(triangle_at_[d], triangle);
  addDegree(a, -1);
  addDegree(b, -1);
  addDegree(c, 1);
  addDegree(d, 1);
}

Triangles SphereMesh::triangles() const {
  Triangles result(3, triangle_count_);
  Eigen::Index column = 0;
  for (const auto& [a, b, c] : vertices_)
    if (a >= 0)
      result.col(column++) << a, b, c;
  return result;
}

}  // namespace spherical_param::internal
