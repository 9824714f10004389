#include "map_hierarchy.h"

#include "corner_table.h"
#include "index_loops.h"
#include "radix_sort.h"
#include "sphere_mesh.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

/// The least mass of a triangle, as a fraction of the mean: the image of a cluster of points,
/// however small it is in space, stays larger than the rounding of doubles.
constexpr double kMinMass = 1e-6;
/// A vertex with more neighbours is taken out only if there are too few others.
constexpr Index kMaxCoarseNeighbors = 8;

/// A vertex that may be taken out; the key sorts by cost.
struct Candidate {
  std::uint32_t key;
  Index vertex;
  Index target;
};

std::uint32_t keyOf(double cost) {
  const float value = cost < 1e30 ? static_cast<float>(cost) : 1e30F;
  std::uint32_t key = 0;
  std::memcpy(&key, &value, sizeof key);
  return key;
}

/// Cost of moving w to ring[j]: the longest edge that this makes, squared, more if triangles become
/// needles, if their normals leave that of the star, or if the valence grows.
double costOf(const Positions& points, const std::vector<Index>& ring, std::size_t j,
              const Vector3d& normal, Index valence) {
  constexpr double worst_shape = 100.0;
  const std::size_t k = ring.size();
  const Vector3d v = points.col(ring[j]);
  double longest = 0.0;
  double shape = 1.0;
  double least_cosine = 1.0;
  Vector3d side = points.col(ring[(j + 1) % k]) - v;
  longest = side.squaredNorm();
  for (std::size_t i = 1; i + 1 < k; ++i) {
    const Vector3d next = points.col(ring[(j + i + 1) % k]) - v;
    const double next_squared = next.squaredNorm();
    const Vector3d cross = side.cross(next);
    const double area = cross.norm();
    const double widest = std::max({side.squaredNorm(), next_squared, (next - side).squaredNorm()});
    // 1 for an equilateral triangle.
    shape = std::max(shape, area * worst_shape > widest ? 0.866 * widest / area : worst_shape);
    least_cosine = std::min(least_cosine, area > 0.0 ? cross.dot(normal) / area : -1.0);
    longest = std::max(longest, next_squared);
    side = next;
  }
  const double more = std::max(0.0, valence - 7.0);
  return longest * shape * (1.0 + 8.0 * (1.0 - least_cosine)) * (1.0 + 0.1 * more * more);
}

/// The numbering of the vertices by breadth-first search: what is near is near in memory, whatever
/// the order of the input, and the frame does not matter.
Indexed<Index> breadthFirst(const Triangles& triangles, std::size_t n, int threads) {
  const CornerTable corners(triangles, n, threads);
  Indexed<Index> order;
  order.reserve(n);
  Indexed<char> known(n, 0);
  order.push_back(0);
  known[0] = 1;
  for (Index i = 0; i < indexCount(order); ++i)
    corners.forEachCorner(order[i], [&](Index t, Index k) {
      const Index next = triangles(nextCorner(k), t);
      if (known[next] == 0) {
        known[next] = 1;
        order.push_back(next);
      }
    });
  return order;
}

Indexed<Index> inverseOf(const Indexed<Index>& order) {
  Indexed<Index> rank(order.size());
  for (Index i = 0; i < indexCount(order); ++i)
    rank[order[i]] = i;
  return rank;
}

Triangles renumbered(const Triangles& triangles, const Indexed<Index>& rank) {
  return triangles.unaryExpr([&](Index v) { return rank[v]; });
}

Indexed<double> massesOf(const Positions& points, const Triangles& triangles, int threads) {
  const Index m = static_cast<Index>(triangles.cols());
  Indexed<double> masses(columnCount(triangles));
  const double sum = sumOfIndices(masses.size(), threads, 0.0, [&](Index t) {
    return masses[t] = 0.5 * areaNormal(points, triangles, t).norm();
  });
  for (double& mass : masses)
    mass = sum > 0.0 ? std::max(mass / sum, kMinMass / m) : 1.0 / m;
  return masses;
}

/// Takes out vertices, and records how.
class Coarsening {
  static constexpr Index none = -1;

public:
  Coarsening(const Positions& points, const Triangles& triangles, int requested, int threads)
      : points_(points), requested_threads_(requested),
        mesh_(triangles, columnCount(points), threads),
        masses_(massesOf(points, triangles, threads)), alive_(columnCount(points)),
        blocked_(alive_.size()), marked_(alive_.size()) {
    std::iota(alive_.begin(), alive_.end(), 0);
    keepMesh();
  }

  MapHierarchy run(const FractionReport& report) {
    const double n = indexCount(alive_);
    Index most_neighbors = kMaxCoarseNeighbors;
    while (alive_.size() > 4) {
      const Index before = indexCount(alive_);
      takeOut(most_neighbors);
      const Index gone = before - indexCount(alive_);
      // With more than 4 vertices there is an edge that can be contracted.
      if (gone == 0 || gone < before / 20)
        most_neighbors = most_neighbors < (Index{1} << 29) ? 2 * most_neighbors : most_neighbors;
      else
        most_neighbors = std::max(kMaxCoarseNeighbors, most_neighbors / 2);
      const Index kept = hierarchy_.meshes.back().vertex_count;
      const double ratio = kept > 1000 ? 0.5 : 0.8;
      if (indexCount(alive_) <= ratio * kept || alive_.size() == 4)
        keepMesh();
      reportFraction(report, 1.0 - indexCount(alive_) / n);
    }
    number();
    return std::move(hierarchy_);
  }

private:
  void takeOut(Index most_neighbors) {
    findCandidates(most_neighbors);
    const std::size_t first = removed_.size();
    const std::size_t most = first + alive_.size() - 4;
    blocked_.clear();
    for (Candidate candidate : candidates_) {
      if (removed_.size() == most)
        break;
      if (blocked_.contains(candidate.vertex) || !chooseTarget(candidate))
        continue;
      const std::size_t ring_begin = ring_.size();
      collapse(candidate.vertex, candidate.target);
      removed_.push_back({candidate.vertex, ring_begin, ring_.size()});
    }
    if (removed_.size() == first)
      return;
    batch_begin_.push_back(first);
    alive_.erase(std::remove_if(alive_.begin(), alive_.end(),
                                [&](Index v) { return mesh_.triangleAt(v) < 0; }),
                 alive_.end());
  }

  /// Whether the mesh stays a manifold if w is moved to its neighbour v, and is no tetrahedron.
  bool canCollapse(Index w, Index v) {
    marked_.clear();
    mesh_.forEachAround(w, [&](Index t, int k) { marked_.insert(mesh_.vertex(t, (k + 1) % 3)); });
    int shared = 0;
    mesh_.forEachAround(v, [&](Index t, int k) {
      shared += marked_.contains(mesh_.vertex(t, (k + 1) % 3)) ? 1 : 0;
    });
    return shared == 2;
  }

  /// Moves w to its neighbour v: flips its edges to v until it has three, and merges these. Records
  /// the ring of w, from v on, and the masses of its triangles.
  void collapse(Index w, Index v) {
    Indexed<Index> star;
    Indexed<Index> ring;
    mesh_.forEachAround(w, [&](Index t, int corner) {
      star.push_back(t);
      ring.push_back(mesh_.vertex(t, (corner + 1) % 3));
    });
    const auto at = std::find(ring.begin(), ring.end(), v) - ring.begin();
    std::rotate(ring.begin(), ring.begin() + at, ring.end());
    std::rotate(star.begin(), star.begin() + at, star.end());
    double mass = 0.0;
    for (Index i = 0; i < ring.count(); ++i) {
      blocked_.insert(ring[i]);
      ring_.push_back(ring[i]);
      ring_masses_.push_back(static_cast<float>(masses_[star[i]]));
      mass += masses_[star[i]];
    }
    Index t = star[0];
    Indexed<Index> fan{-1};  // triangle i has v, ring i and ring i + 1
    while (mesh_.degree(w) > 3) {
      const int corner = mesh_.cornerOf(t, v);
      const Index next = mesh_.neighbor(t, corner);
      mesh_.flipFree(t, corner);
      fan.push_back(t);
      t = next;
    }
    fan.push_back(mesh_.merge(w));

    const auto area = [&](Index i) {
      const Vector3d apex = points_.col(v);
      return 0.5 * (points_.col(ring[i]) - apex).cross(points_.col(ring[i + 1]) - apex).norm();
    };
    const Index count = fan.count() - 1;
    double sum = 0.0;
    for (Index i = 1; i <= count; ++i)
      sum += area(i);
    // A part is divided evenly, so that a triangle without area gets some of it.
    constexpr double even = 0.1;
    for (Index i = 1; i <= count; ++i)
      masses_[fan[i]] =
          mass * (sum > 0.0 ? even / count + (1.0 - even) * area(i) / sum : 1.0 / count);
  }

  void findCandidates(Index most_neighbors) {
    candidates_ =
        collectBlocks<Candidate>(alive_.size(), threadCount(requested_threads_, alive_.size()), {},
                                 [&](Index begin, Index end, std::vector<Candidate>& found) {
                                   std::vector<Index> ring;
                                   for (Index i = begin; i < end; ++i) {
                                     const Index w = alive_[i];
                                     if (mesh_.degree(w) > most_neighbors)
                                       continue;
                                     const auto [cost, target] =
                                         cheapestTarget(w, ring, [](Index) { return true; });
                                     if (target != none)
                                       found.push_back({keyOf(cost), w, target});
                                   }
                                 });
    radixSort(candidates_);
  }

  /// The neighbours of w, and the mean normal of its triangles, a unit vector or zero.
  Vector3d ringOf(Index w, std::vector<Index>& ring) const {
    ring.clear();
    mesh_.forEachAround(
        w, [&](Index t, int corner) { ring.push_back(mesh_.vertex(t, (corner + 1) % 3)); });
    const Vector3d at = points_.col(w);
    Vector3d normal = Vector3d::Zero();
    Vector3d side = points_.col(ring.back()) - at;
    for (const Index neighbor : ring) {
      const Vector3d next = points_.col(neighbor) - at;
      normal += side.cross(next);
      side = next;
    }
    const double length = normal.norm();
    return length > 0.0 ? Vector3d(normal / length) : Vector3d(Vector3d::Zero());
  }

  /// Whether the candidate can be taken out; to another neighbour if not to its target.
  bool chooseTarget(Candidate& candidate) {
    const Index w = candidate.vertex;
    if (canCollapse(w, candidate.target))
      return true;
    candidate.target =
        cheapestTarget(w, work_ring_, [&](Index v) { return canCollapse(w, v); }).second;
    return candidate.target != none;
  }

  /// The least cost of moving w to one of its neighbours for which is_allowed(), and that
  /// neighbour.
  ///
  /// \param ring to work in.
  template <typename IsAllowed>
  std::pair<double, Index> cheapestTarget(Index w, std::vector<Index>& ring,
                                          const IsAllowed& is_allowed) const {
    const Vector3d normal = ringOf(w, ring);
    std::pair<double, Index> best(std::numeric_limits<double>::infinity(), none);
    for (std::size_t j = 0; j < ring.size(); ++j) {
      const Index v = ring[j];
      const double cost = costOf(points_, ring, j, normal, mesh_.degree(v) + mesh_.degree(w) - 4);
      if ((cost < best.first || best.second == none) && is_allowed(v))
        best = {cost, v};
    }
    return best;
  }

  void keepMesh() {
    MapMesh mesh;
    mesh.vertex_count = indexCount(alive_);
    mesh.triangles.resize(3, 2 * mesh.vertex_count - 4);
    mesh.masses.reserve(columnCount(mesh.triangles));
    Eigen::Index t = 0;
    for (Index i = 0; i < mesh_.size(); ++i)
      if (const auto& [u, v, w] = mesh_.vertices(i); u >= 0) {
        mesh.triangles.col(t++) << u, v, w;
        mesh.masses.push_back(static_cast<float>(masses_[i]));
      }
    hierarchy_.meshes.push_back(std::move(mesh));
  }

  /// Numbers the vertices, those that were taken out last first; of a batch in their order here.
  void number() {
    Indexed<Index>& order = hierarchy_.order;
    order = alive_;
    hierarchy_.ring_begin.push_back(0);
    hierarchy_.ring.reserve(ring_.size());
    hierarchy_.ring_masses.reserve(ring_.size());
    batch_begin_.push_back(removed_.size());
    std::size_t end = removed_.size();
    for (std::size_t b = batch_begin_.size() - 1; b-- > 0;) {
      hierarchy_.batches.push_back(indexCount(order));
      const std::size_t begin = batch_begin_[b];
      std::sort(&removed_[begin], &removed_[begin] + (end - begin),
                [](const Removed& one, const Removed& other) { return one.vertex < other.vertex; });
      for (std::size_t i = begin; i < end; ++i) {
        order.push_back(removed_[i].vertex);
        for (std::size_t k = removed_[i].ring_begin; k < removed_[i].ring_end; ++k) {
          hierarchy_.ring.push_back(ring_[k]);
          hierarchy_.ring_masses.push_back(ring_masses_[k]);
        }
        hierarchy_.ring_begin.push_back(static_cast<std::uint32_t>(hierarchy_.ring.size()));
      }
      end = begin;
    }
    hierarchy_.batches.push_back(indexCount(order));
    const Indexed<Index> rank = inverseOf(order);
    for (Index& v : hierarchy_.ring)
      v = rank[v];
    for (MapMesh& mesh : hierarchy_.meshes)
      mesh.triangles = renumbered(mesh.triangles, rank);
    hierarchy_.points = points_(Eigen::all, order);
  }

  struct Removed {
    Index vertex;
    std::size_t ring_begin;
    std::size_t ring_end;
  };

  const Positions& points_;
  int requested_threads_;
  SphereMesh mesh_;
  Indexed<double> masses_;  // of the triangles
  Indexed<Index> alive_;
  IndexSet blocked_;  // vertices at which the batch changes something
  IndexSet marked_;
  std::vector<Candidate> candidates_;
  std::vector<Index> work_ring_;
  std::vector<Removed> removed_;
  std::vector<std::size_t> batch_begin_;
  std::vector<Index> ring_;
  std::vector<float> ring_masses_;
  MapHierarchy hierarchy_;
};

}  // namespace

MapHierarchy buildMapHierarchy(const Positions& points, const Triangles& triangles, int threads,
                               const FractionReport& report) {
  const int most = threadCount(threads, columnCount(points));
  const Indexed<Index> order = breadthFirst(triangles, columnCount(points), most);
  const Positions scaled = scaledToUnit(points)(Eigen::all, order);
  MapHierarchy hierarchy =
      Coarsening(scaled, renumbered(triangles, inverseOf(order)), threads, most).run(report);
  for (Index& v : hierarchy.order)
    v = order[v];
  return hierarchy;
}

}  // namespace spherical_param::internal
