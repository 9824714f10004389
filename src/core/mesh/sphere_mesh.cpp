#include "sphere_mesh.h"

#include "parallel.h"
#include "union_find.h"

#include <algorithm>
#include <cstdint>

namespace spherical_param::internal {

namespace {

/// Finds the other triangle of each side. A side waits with the lower of its vertices for its other
/// triangle, which comes soon in a mesh whose triangles are in the order of their places: all that
/// wait are few, and stay in the processor's caches.
class SidePairing {
public:
  struct Side {
    Index from;
    Index to;
    Index triangle;
    std::uint8_t corner;
  };

  explicit SidePairing(std::size_t vertex_count) : first_(vertex_count, kNone) {}

  /// Calls pair(side, other) if the other one waits for this one, or lets this one wait.
  template <typename Pair>
  void add(const Side& side, const Pair& pair) {
    std::uint32_t* place = &first_[static_cast<std::size_t>(std::min(side.from, side.to))];
    std::uint32_t* const list = place;
    while (*place != kNone) {
      Waiting& waiting = waiting_[*place];
      if (waiting.side.from == side.to && waiting.side.to == side.from) {
        pair(side, waiting.side);
        const std::uint32_t freed = *place;
        *place = waiting.next;
        waiting.next = free_;
        free_ = freed;
        return;
      }
      place = &waiting.next;
    }
    std::uint32_t own = free_;
    if (own == kNone) {
      own = static_cast<std::uint32_t>(waiting_.size());
      // May move what the places point to, but not the lists' beginnings.
      waiting_.push_back({});
    } else {
      free_ = waiting_[own].next;
    }
    waiting_[own] = {side, *list};
    *list = own;
  }

  /// Calls visit(side) for all that wait.
  template <typename Visit>
  void forEachWaiting(const Visit& visit) const {
    for (const std::uint32_t first : first_)
      for (std::uint32_t i = first; i != kNone; i = waiting_[i].next)
        visit(waiting_[i].side);
  }

private:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  struct Waiting {
    Side side;
    std::uint32_t next;
  };

  std::vector<std::uint32_t> first_;
  std::vector<Waiting> waiting_;
  std::uint32_t free_ = kNone;
};

/// Parts of a mesh that are paired on their own at first: each takes memory.
constexpr std::size_t kMaxParts = 4;

}  // namespace

SphereMesh::SphereMesh(const Triangles& triangles, std::size_t vertex_count, int threads)
    : triangle_at_(vertex_count, -1), degree_(vertex_count, 0),
      triangle_count_(static_cast<Index>(triangles.cols())) {
  const auto m = static_cast<std::size_t>(triangles.cols());
  // Room for all splits: entries must not move while changes are recorded.
  vertices_.reserve(std::max(m, 2 * vertex_count));
  neighbors_.reserve(std::max(m, 2 * vertex_count));
  vertices_.resize(m);
  neighbors_.assign(m, {-1, -1, -1});

  const auto pair = [this](const SidePairing::Side& side, const SidePairing::Side& other) {
    neighbors_[static_cast<std::size_t>(side.triangle)][side.corner] = other.triangle;
    neighbors_[static_cast<std::size_t>(other.triangle)][other.corner] = side.triangle;
  };
  const std::size_t parts = std::min(kMaxParts, static_cast<std::size_t>(threadCount(threads, m)));
  std::vector<std::vector<SidePairing::Side>> left(parts);
  // A block of nothing but its number for each part.
  forEachBlock(
      parts * kBlockSize, static_cast<int>(parts), [&](std::size_t part, std::size_t, std::size_t) {
        SidePairing pairing(vertex_count);
        for (std::size_t t = part * m / parts; t < (part + 1) * m / parts; ++t) {
          const auto column = static_cast<Eigen::Index>(t);
          const std::array<Index, 3> v{triangles(0, column), triangles(1, column),
                                       triangles(2, column)};
          vertices_[t] = v;
          for (std::size_t k = 0; k < 3; ++k)
            pairing.add({v[(k + 1) % 3], v[(k + 2) % 3], static_cast<Index>(t),
                         static_cast<std::uint8_t>(k)},
                        pair);
        }
        pairing.forEachWaiting([&](const SidePairing::Side& side) { left[part].push_back(side); });
      });
  if (parts > 1) {
    SidePairing pairing(vertex_count);
    for (const auto& sides : left)
      for (const SidePairing::Side& side : sides)
        pairing.add(side, pair);
    pairing.forEachWaiting([&](const SidePairing::Side&) { is_paired_ = false; });
  } else {
    is_paired_ = left.front().empty();
  }
  for (std::size_t t = 0; t < m; ++t)
    for (const Index v : vertices_[t]) {
      ++degree_[static_cast<std::size_t>(v)];
      triangle_at_[static_cast<std::size_t>(v)] = static_cast<Index>(t);
    }
}

bool SphereMesh::isFan(Index v) const {
  std::array<Index, 16> few{};
  std::vector<Index> many;
  const auto count = static_cast<std::size_t>(degree(v));
  if (count > few.size())
    many.resize(count);
  Index* const ring = count > few.size() ? many.data() : few.data();
  std::size_t reached = 0;
  const Index first = triangleAt(v);
  Index t = first;
  do {
    if (reached == count)
      return false;
    const int corner = cornerOf(t, v);
    ring[reached++] = vertex(t, (corner + 1) % 3);
    t = neighbor(t, (corner + 1) % 3);
  } while (t != first);
  if (reached != count)
    return false;
  if (count > few.size()) {
    std::sort(many.begin(), many.end());
    return std::adjacent_find(many.begin(), many.end()) == many.end();
  }
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (ring[i] == ring[j])
        return false;
  return true;
}

bool SphereMesh::isSphere(int threads) const {
  const auto m = vertices_.size();
  const auto n = triangle_at_.size();
  if (n < 4 || m != 2 * n - 4 || !is_paired_)
    return false;
  threads = threadCount(threads, m);
  if (sumOfBlocks(m, threads, std::size_t{0}, [&](std::size_t begin, std::size_t end) {
        std::size_t wrong = 0;
        for (std::size_t t = begin; t < end; ++t) {
          const auto& [a, b, c] = vertices_[t];
          wrong += a == b || b == c || c == a ? 1 : 0;
        }
        return wrong;
      }) > 0)
    return false;
  // Now every walk around a vertex closes: is it through all of its triangles?
  if (sumOfBlocks(n, threads, std::size_t{0}, [&](std::size_t begin, std::size_t end) {
        std::size_t wrong = 0;
        for (std::size_t v = begin; v < end; ++v)
          wrong += triangle_at_[v] < 0 || !isFan(static_cast<Index>(v)) ? 1 : 0;
        return wrong;
      }) > 0)
    return false;
  // One piece, so that 2n - 4 triangles make it a sphere.
  UnionFind pieces(n);
  std::size_t joined = 0;
  for (const auto& [a, b, c] : vertices_)
    joined += (pieces.unite(a, b) ? 1U : 0U) + (pieces.unite(b, c) ? 1U : 0U);
  return joined == n - 1;
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

void SphereMesh::rollBack(std::size_t first) {
  for (; changes_.size() > first; changes_.pop_back())
    *changes_.back().first = changes_.back().second;
  if (first == 0)
    commit();
}

Triangles SphereMesh::triangles() const {
  static_assert(sizeof(std::array<Index, 3>) == 3 * sizeof(Index), "columns of a matrix");
  if (triangle_count_ == size())
    return Eigen::Map<const Triangles>(vertices_.data()->data(), 3, triangle_count_);
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
