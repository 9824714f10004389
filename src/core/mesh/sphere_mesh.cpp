#include "sphere_mesh.h"

#include "corner_table.h"
#include "rows.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

SphereMesh::SphereMesh(const Triangles& triangles, std::size_t vertex_count, int threads)
    : triangle_at_(vertex_count, -1), degree_(vertex_count, 0),
      triangle_count_(static_cast<Index>(triangles.cols())) {
  const auto m = columnCount(triangles);
  // Room for all splits: entries must not move while changes are recorded.
  const std::size_t most = std::max(m, 2 * vertex_count);
  vertices_.reserve(most);
  neighbors_.reserve(most);
  is_open_.reserve(most);
  vertices_.resize(m);
  neighbors_.resize(m);
  is_open_.resize(m, 0);
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

Index SphereMesh::takeSlot() {
  journal_.set(triangle_count_, triangle_count_ + 1);
  if (free_ < 0) {
    vertices_.push_back({-1, -1, -1});
    neighbors_.push_back({-1, -1, -1});
    is_open_.push_back(0);
    return size() - 1;
  }
  const Index slot = free_;
  journal_.set(free_, vertex(slot, 1));
  return slot;
}

void SphereMesh::freeSlot(Index t) {
  journal_.set(triangle_count_, triangle_count_ - 1);
  setTriangle(t, {-1, free_, -1}, {-1, -1, -1});
  journal_.set(free_, t);
}

std::array<Index, 3> SphereMesh::split(Index triangle, Index new_vertex) {
  const std::array<Index, 3> v = vertices_[triangle];
  const std::array<Index, 3> n = neighbors_[triangle];
  const std::array<Index, 3> parts{triangle, takeSlot(), takeSlot()};
  for (std::size_t k = 0; k < 3; ++k)
    // Part k has the side opposite to corner k.
    setTriangle(parts[k], {new_vertex, v[(k + 1) % 3], v[(k + 2) % 3]},
                {n[k], parts[(k + 1) % 3], parts[(k + 2) % 3]});
  for (std::size_t k = 1; k < 3; ++k) {
    replaceNeighbor(n[k], triangle, parts[k]);
    setOpen(parts[k], isOpen(triangle));
  }
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
  setOpen(t, std::any_of(around.begin(), around.end(), [&](Index u) { return isOpen(u); }));
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
  freeSlot(around[1]);
  freeSlot(around[2]);
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

std::vector<Index> SphereMesh::surface() const {
  std::vector<Index> triangles;
  for (Index t = 0; t < size(); ++t)
    if (isUsed(t) && !isOpen(t))
      triangles.push_back(t);
  return triangles;
}

Triangles SphereMesh::surfaceTriangles() const {
  const std::vector<Index> surface = this->surface();
  Triangles result(3, static_cast<Eigen::Index>(surface.size()));
  Eigen::Index column = 0;
  for (const Index t : surface)
    result.col(column++) << vertex(t, 0), vertex(t, 1), vertex(t, 2);
  return result;
}

std::size_t SphereMesh::surfaceVertexCount() const {
  std::vector<Index> used = verticesOf(surface());
  sortUnique(used);
  return used.size();
}

std::size_t SphereMesh::genus() const {
  // V - E + F = 2 - 2 g, with 3 F = 2 E.
  const auto vertices =
      std::count_if(degree_.begin(), degree_.end(), [](Index degree) { return degree > 0; });
  return static_cast<std::size_t>(triangle_count_ / 2 + 2 - vertices) / 2;
}

void SphereMesh::turnOver() {
  for (Index t = 0; t < size(); ++t) {
    if (!isUsed(t))
      continue;
    std::swap(vertices_[t][1], vertices_[t][2]);
    std::swap(neighbors_[t][1], neighbors_[t][2]);
  }
}

Fan trianglesAround(const SphereMesh& mesh, Index v) {
  Fan around;
  mesh.forEachAround(v, [&](Index t, int) { around.push_back(t); });
  return around;
}

std::vector<Fan> fansAt(const SphereMesh& mesh, Index v, bool of_open) {
  const auto is_other = [&](Index t) { return mesh.isOpen(t) != of_open; };
  Fan around = trianglesAround(mesh, v);
  std::rotate(around.begin(), std::find_if(around.begin(), around.end(), is_other), around.end());
  std::vector<Fan> fans;
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (is_other(around[i]))
      continue;
    if (i == 0 || is_other(around[i - 1]))
      fans.emplace_back();
    fans.back().push_back(around[i]);
  }
  return fans;
}

}  // namespace spherical_param::internal
