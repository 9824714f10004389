#include "sphere_overlay.h"

#include "exact_predicates.h"
#include "parallel.h"
#include "space_filling_curve.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace spherical_param::internal {
namespace {

int minorSign(const Eigen::Vector3d& u, const Eigen::Vector3d& v, int a, int b) {
  return orientation2d({u[a], u[b]}, {v[a], v[b]}, Eigen::Vector2d::Zero());
}

int signOf(double x) {
  return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
}

/// For i < j < k: the sign of the first coefficient that does not vanish of the determinant, as a
/// polynomial in what the coordinates are moved by.
int perturbedSign(const Eigen::Vector3d& i, const Eigen::Vector3d& j, const Eigen::Vector3d& k) {
  const auto first = [](std::initializer_list<int> signs) {
    for (const int sign : signs)
      if (sign != 0)
        return sign;
    return 0;
  };
  // Coordinates are moved by amounts of which each is smaller than any product of those before it:
  // the last of i, the one before it, the first of i; then those of j; those of k do not count.
  const int sign = first({minorSign(j, k, 0, 1), -minorSign(j, k, 0, 2), minorSign(j, k, 1, 2),
                          -minorSign(i, k, 0, 1), signOf(k[0]), -signOf(k[1]),
                          minorSign(i, k, 0, 2), signOf(k[2])});
  return sign == 0 ? 1 : sign;
}

double determinantOf(const Positions& points, Index i, Index j, Index k) {
  const Eigen::Vector3d a = points.col(i);
  const Eigen::Vector3d ab = points.col(j) - points.col(i);
  const Eigen::Vector3d ac = points.col(k) - points.col(i);
  return a.dot(ab.cross(ac));
}

[[noreturn]] void failLost() {
  throw ComputeError("morphSurfaces: a triangulation of the sphere does not cover it once; use "
                     "maps that are one to one");
}

/// Place of a point in the flat triangle that its direction meets.
SphereLocation placeIn(const Positions& points, const Triangles& triangles, Index triangle,
                       Index point) {
  SphereLocation location;
  location.triangle = triangle;
  for (int k = 0; k < 3; ++k) {
    const Index a = triangles((k + 1) % 3, triangle);
    const Index b = triangles((k + 2) % 3, triangle);
    location.weights[k] = std::max(0.0, determinantOf(points, point, a, b));
  }
  const double sum = location.weights.sum();
  // Of a triangle without area to within rounding, the middle.
  if (sum > 0.0)
    location.weights /= sum;
  else
    location.weights.setConstant(1.0 / 3.0);
  return location;
}

/// Place on an edge, as a share of the way to its second end.
SphereLocation placeOn(const ArcMesh& mesh, Index edge, double share) {
  const Index corner = mesh.cornerOppositeTo(edge);
  SphereLocation location;
  location.triangle = corner / 3;
  location.weights[(corner % 3 + 1) % 3] = 1.0 - share;
  location.weights[(corner % 3 + 2) % 3] = share;
  return location;
}

SphereLocation placeAtCorner(Index triangle, int corner) {
  SphereLocation location;
  location.triangle = triangle;
  location.weights[corner] = 1.0;
  return location;
}

/// Both shares at which two arcs cross that are known to do so.
std::array<double, 2> crossingOf(const Positions& points, const std::array<Index, 2>& a,
                                 const std::array<Index, 2>& b) {
  const auto share = [&points](const std::array<Index, 2>& of, const std::array<Index, 2>& other) {
    const double from = std::abs(determinantOf(points, other[0], other[1], of[0]));
    const double to = std::abs(determinantOf(points, other[0], other[1], of[1]));
    return from + to > 0.0 ? from / (from + to) : -1.0;
  };
  std::array<double, 2> shares{share(a, b), share(b, a)};
  if (shares[0] >= 0.0 && shares[1] >= 0.0)
    return shares;
  // On one great circle: the middle of what they have in common.
  const auto along = [&points](const std::array<Index, 2>& of, const Eigen::Vector3d& place) {
    const Eigen::Vector3d step = points.col(of[1]) - points.col(of[0]);
    return std::clamp((place - points.col(of[0])).dot(step) / step.squaredNorm(), 0.0, 1.0);
  };
  const double middle = 0.5 * (along(a, points.col(b[0])) + along(a, points.col(b[1])));
  const Eigen::Vector3d place = (1.0 - middle) * points.col(a[0]) + middle * points.col(a[1]);
  return {middle, along(b, place.normalized())};
}

/// The edges of one mesh that each edge of another crosses, in order.
struct Crossings {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> edges;
  std::vector<Index> along;  ///< the edge of the other mesh that it is itself; -1: none

  std::size_t begin(Index edge) const { return offsets[static_cast<std::size_t>(edge)]; }
  std::size_t end(Index edge) const { return offsets[static_cast<std::size_t>(edge) + 1]; }
};

/// \param triangle_of of the points that are no vertices of `through`
Crossings crossingsOf(const ArcMesh& mesh, const ArcMesh& through,
                      const std::vector<Index>& triangle_of, int threads) {
  const auto count = static_cast<std::size_t>(mesh.edgeCount());
  std::vector<std::vector<Index>> of_block((count + kBlockSize - 1) / kBlockSize);
  std::vector<std::size_t> sizes(count, 0);
  std::vector<char> lost(of_block.size(), 0);
  Crossings crossings;
  crossings.along.resize(count);
  forEachBlock(count, threads, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const std::array<Index, 2> ends = mesh.ends(static_cast<Index>(e));
      const std::size_t before = of_block[block].size();
      const ArcMesh::Walk walk = through.walk(
          ends[0], ends[1], triangle_of[static_cast<std::size_t>(ends[0])], of_block[block]);
      sizes[e] = of_block[block].size() - before;
      crossings.along[e] = walk.along;
      if (walk.lost)
        lost[block] = 1;
    }
  });
  if (std::find(lost.begin(), lost.end(), 1) != lost.end())
    failLost();
  for (const std::size_t size : sizes)
    crossings.offsets.push_back(crossings.offsets.back() + size);
  crossings.edges.reserve(crossings.offsets.back());
  for (const std::vector<Index>& edges : of_block)
    crossings.edges.insert(crossings.edges.end(), edges.begin(), edges.end());
  return crossings;
}

/// Rounding may swap crossings that are near each other: their order is known.
void ascend(double& share, double& least) {
  share = least = std::max(share, least);
}

}  // namespace

int orientationOf(const Positions& points, Index i, Index j, Index k) {
  const int sign =
      orientation3d(Eigen::Vector3d::Zero(), points.col(i), points.col(j), points.col(k));
  if (sign != 0)
    return sign;
  std::array<Index, 3> order{i, j, k};
  int parity = 1;
  for (const auto& [a, b] : {std::pair(0U, 1U), std::pair(1U, 2U), std::pair(0U, 1U)})
    if (order[a] > order[b]) {
      std::swap(order[a], order[b]);
      parity = -parity;
    }
  return parity * perturbedSign(points.col(order[0]), points.col(order[1]), points.col(order[2]));
}

ArcMesh::ArcMesh(const Positions& points, const Triangles& triangles)
    : points_(points), triangles_(triangles), across_(static_cast<std::size_t>(triangles.size())),
      edge_of_(across_.size()), corner_at_(static_cast<std::size_t>(points.cols()), -1) {
  struct Side {
    Index low, high, corner;
    bool operator<(const Side& other) const {
      return low != other.low     ? low < other.low
             : high != other.high ? high < other.high
                                  : corner < other.corner;
    }
  };
  std::vector<Side> sides;
  sides.reserve(across_.size());
  for (Index t = 0; t < static_cast<Index>(triangles.cols()); ++t)
    for (Index k = 0; k < 3; ++k) {
      const Index begin = vertex(t, (k + 1) % 3);
      const Index end = vertex(t, (k + 2) % 3);
      sides.push_back({std::min(begin, end), std::max(begin, end), 3 * t + k});
      Index& corner = corner_at_[static_cast<std::size_t>(vertex(t, k))];
      if (corner < 0)
        corner = 3 * t + k;
    }
  std::sort(sides.begin(), sides.end());
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2) {
    const auto edge = static_cast<Index>(edge_corner_.size());
    edge_corner_.push_back(sides[s].corner);
    for (std::size_t i = 0; i < 2; ++i) {
      across_[static_cast<std::size_t>(sides[s + i].corner)] = sides[s + 1 - i].corner;
      edge_of_[static_cast<std::size_t>(sides[s + i].corner)] = edge;
    }
  }
}

std::array<Index, 2> ArcMesh::ends(Index edge) const {
  const Index corner = edge_corner_[static_cast<std::size_t>(edge)];
  return {vertex(corner / 3, (corner % 3 + 1) % 3), vertex(corner / 3, (corner % 3 + 2) % 3)};
}

ArcMesh::Walk ArcMesh::walk(Index from, Index to, Index start, std::vector<Index>& crossed) const {
  Walk result;
  // The corner opposite to the side by which the arc leaves its first triangle.
  Index corner = -1;
  const auto leaves_by = [&](Index right, Index left) {
    return orientationOf(points_, from, right, to) > 0 &&
           orientationOf(points_, from, left, to) < 0;
  };
  if (isVertex(from)) {
    const Index first = corner_at_[static_cast<std::size_t>(from)];
    Index around = first;
    do {
      const Index t = around / 3;
      const Index k = around % 3;
      const Index right = vertex(t, (k + 1) % 3);
      const Index left = vertex(t, (k + 2) % 3);
      if (right == to || left == to) {
        const Index opposite = 3 * t + (k + (right == to ? 2 : 1)) % 3;
        result.along = edge_of_[static_cast<std::size_t>(opposite)];
        return result;
      }
      if (leaves_by(right, left)) {
        corner = around;
        break;
      }
      around = nextAround(around);
    } while (around != first);
    if (corner < 0) {
      result.lost = true;
      return result;
    }
    if (orientationOf(points_, vertex(corner / 3, (corner % 3 + 1) % 3),
                      vertex(corner / 3, (corner % 3 + 2) % 3), to) > 0) {
      result.triangle = corner / 3;
      return result;
    }
  } else {
    bool inside = true;
    for (Index k = 0; k < 3; ++k) {
      if (vertex(start, k) == to)
        return result;
      const Index right = vertex(start, (k + 1) % 3);
      const Index left = vertex(start, (k + 2) % 3);
      if (right == to || left == to)
        continue;
      if (orientationOf(points_, right, left, to) < 0) {
        inside = false;
        if (leaves_by(right, left))
          corner = 3 * start + k;
      }
    }
    if (inside) {
      result.triangle = start;
      return result;
    }
    if (corner < 0) {
      result.lost = true;
      return result;
    }
  }
  for (std::size_t steps = 0; steps <= across_.size(); ++steps) {
    crossed.push_back(edge_of_[static_cast<std::size_t>(corner)]);
    const Index entry = across_[static_cast<std::size_t>(corner)];
    const Index t = entry / 3;
    const Index k = entry % 3;
    // Seen from this triangle the side runs the other way round.
    const Index left = vertex(t, (k + 1) % 3);
    const Index right = vertex(t, (k + 2) % 3);
    const Index apex = vertex(t, k);
    if (apex == to)
      return result;
    if (orientationOf(points_, from, to, apex) > 0) {
      corner = 3 * t + (k + 1) % 3;
      if (orientationOf(points_, right, apex, to) > 0) {
        result.triangle = t;
        return result;
      }
    } else {
      corner = 3 * t + (k + 2) % 3;
      if (orientationOf(points_, apex, left, to) > 0) {
        result.triangle = t;
        return result;
      }
    }
  }
  result.lost = true;
  return result;
}

std::vector<SphereLocation> locateAll(const Positions& points, const Triangles& triangles,
                                      const std::vector<Index>& queries) {
  const ArcMesh mesh(points, triangles);
  std::vector<SphereLocation> locations(queries.size());
  std::vector<Index> crossed;
  Index last = 0;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Index point = queries[q];
    if (mesh.isVertex(point)) {
      mesh.forEachEdgeAt(point, [&](Index edge, bool, Index) {
        const Index corner = mesh.cornerOppositeTo(edge);
        const Index second = (corner % 3 + 2) % 3;
        const Index k = mesh.vertex(corner / 3, second) == point ? second : (corner % 3 + 1) % 3;
        locations[q] = placeAtCorner(corner / 3, static_cast<int>(k));
      });
      last = locations[q].triangle;
      continue;
    }
    crossed.clear();
    const ArcMesh::Walk walk = mesh.walk(mesh.vertex(last, 0), point, -1, crossed);
    if (walk.lost || walk.triangle < 0)
      return {};
    last = walk.triangle;
    locations[q] = placeIn(points, triangles, last, point);
  }
  return locations;
}

SphereOverlay overlaySpheres(const Positions& first, const Triangles& first_triangles,
                             const Positions& second, const Triangles& second_triangles,
                             const std::vector<Index>& partner, int threads) {
  // One numbering for the vertices of both.
  std::vector<Index> number(partner);
  auto vertex_count = static_cast<Index>(first.cols());
  for (Index& i : number)
    if (i < 0)
      i = vertex_count++;
  Positions points(3, vertex_count);
  points.leftCols(first.cols()) = first;
  for (std::size_t i = 0; i < number.size(); ++i)
    points.col(number[i]) = second.col(static_cast<Eigen::Index>(i));
  Triangles renumbered(3, second_triangles.cols());
  for (Eigen::Index i = 0; i < renumbered.size(); ++i)
    renumbered.data()[i] = number[static_cast<std::size_t>(second_triangles.data()[i])];

  std::vector<Index> order(static_cast<std::size_t>(vertex_count));
  {
    const std::vector<Index> morton = mortonOrder(points);
    std::copy(morton.begin(), morton.end(), order.begin());
  }
  const ArcMesh mesh_a(points, first_triangles);
  const ArcMesh mesh_b(points, renumbered);
  std::vector<SphereLocation> in_a(order.size());
  std::vector<SphereLocation> in_b(order.size());
  std::vector<Index> triangle_a(order.size(), -1);
  std::vector<Index> triangle_b(order.size(), -1);
  {
    const std::array<const Triangles*, 2> triangles{&first_triangles, &renumbered};
    bool lost = false;
    forEachTask(2, std::min(threads, 2), [&](std::size_t, std::size_t m) {
      const std::vector<SphereLocation> found = locateAll(points, *triangles[m], order);
      for (std::size_t q = 0; q < found.size(); ++q) {
        const auto i = static_cast<std::size_t>(order[q]);
        (m == 0 ? in_a : in_b)[i] = found[q];
        (m == 0 ? triangle_a : triangle_b)[i] = found[q].triangle;
      }
    });
    for (std::size_t i = 0; i < order.size(); ++i)
      lost = lost || triangle_a[i] < 0 || triangle_b[i] < 0;
    if (lost)
      failLost();
  }

  const Crossings of_b = crossingsOf(mesh_b, mesh_a, triangle_a, threads);
  const Crossings of_a = crossingsOf(mesh_a, mesh_b, triangle_b, threads);
  const std::size_t crossing_count = of_b.edges.size();
  if (of_a.edges.size() != crossing_count)
    failLost();

  SphereOverlay overlay;
  const std::size_t w = order.size() + crossing_count;
  overlay.first = std::move(in_a);
  overlay.second = std::move(in_b);
  overlay.first.resize(w);
  overlay.second.resize(w);

  // The crossings of each edge of the first mesh, by the edge of the second, to be found there.
  std::vector<std::pair<Index, Index>> by_edge(crossing_count);  // edge of the second, node
  {
    std::vector<std::size_t> end(of_a.offsets.begin(), of_a.offsets.end() - 1);
    for (Index e = 0; e < mesh_b.edgeCount(); ++e)
      for (std::size_t c = of_b.begin(e); c < of_b.end(e); ++c) {
        const auto a = static_cast<std::size_t>(of_b.edges[c]);
        if (end[a] >= of_a.offsets[a + 1])
          failLost();
        by_edge[end[a]++] = {e, static_cast<Index>(order.size() + c)};
      }
  }
  std::vector<Index> nodes_of_a(crossing_count);  // in the order along the edges of the first
  std::vector<double> share_of_a(crossing_count);
  std::vector<double> share_of_b(crossing_count);
  std::vector<char> from_left(crossing_count);  // the second's edge comes from left of the first's
  for (Index e = 0; e < mesh_a.edgeCount(); ++e) {
    const auto begin = by_edge.begin() + static_cast<std::ptrdiff_t>(of_a.begin(e));
    const auto end = by_edge.begin() + static_cast<std::ptrdiff_t>(of_a.end(e));
    const std::array<Index, 2> ends = mesh_a.ends(e);
    double least = 0.0;
    for (std::size_t c = of_a.begin(e); c < of_a.end(e); ++c) {
      const auto found = std::lower_bound(begin, end, std::pair(of_a.edges[c], Index{0}));
      if (found == end || found->first != of_a.edges[c])
        failLost();
      nodes_of_a[c] = found->second;
      const auto x = static_cast<std::size_t>(found->second) - order.size();
      const std::array<Index, 2> other = mesh_b.ends(found->first);
      const std::array<double, 2> shares = crossingOf(points, ends, other);
      share_of_a[x] = shares[0];
      share_of_b[x] = shares[1];
      ascend(share_of_a[x], least);
      from_left[x] = orientationOf(points, ends[0], ends[1], other[0]) > 0 ? 1 : 0;
      overlay.first[static_cast<std::size_t>(found->second)] = placeOn(mesh_a, e, share_of_a[x]);
    }
  }
  overlay.directions.resize(3, static_cast<Eigen::Index>(w));
  overlay.directions.leftCols(vertex_count) = points;
  for (Index e = 0; e < mesh_b.edgeCount(); ++e) {
    double least = 0.0;
    for (std::size_t x = of_b.begin(e); x < of_b.end(e); ++x) {
      ascend(share_of_b[x], least);
      overlay.second[order.size() + x] = placeOn(mesh_b, e, share_of_b[x]);
      const std::array<Index, 2> ends = mesh_a.ends(of_b.edges[x]);
      overlay.directions.col(static_cast<Eigen::Index>(order.size() + x)) =
          ((1.0 - share_of_a[x]) * points.col(ends[0]) + share_of_a[x] * points.col(ends[1]))
              .normalized();
    }
  }

  // The way out of each node along each of its edges, counter-clockwise.
  std::vector<std::size_t> ways(w + 1, 0);
  std::vector<std::size_t> way_a(2 * static_cast<std::size_t>(mesh_a.edgeCount()), 0);
  std::vector<std::size_t> way_b(2 * static_cast<std::size_t>(mesh_b.edgeCount()), 0);
  {
    struct Way {
      Index edge;
      bool is_second, is_begin;
      Index towards;
    };
    std::vector<Way> around;
    for (Index v = 0; v < vertex_count; ++v) {
      around.clear();
      if (mesh_a.isVertex(v))
        mesh_a.forEachEdgeAt(v, [&](Index edge, bool is_begin, Index towards) {
          around.push_back({edge, false, is_begin, towards});
        });
      if (mesh_b.isVertex(v))
        mesh_b.forEachEdgeAt(v, [&](Index edge, bool is_begin, Index towards) {
          if (of_b.along[static_cast<std::size_t>(edge)] < 0)
            around.push_back({edge, true, is_begin, towards});
        });
      if (mesh_a.isVertex(v) && mesh_b.isVertex(v)) {
        const Index zero = around[0].towards;
        const auto half = [&](const Way& way) {
          return way.towards != zero && orientationOf(points, v, zero, way.towards) < 0;
        };
        std::sort(around.begin() + 1, around.end(), [&](const Way& one, const Way& other) {
          const bool half_of_one = half(one);
          const bool half_of_other = half(other);
          if (half_of_one != half_of_other)
            return half_of_other;
          return one.towards != other.towards &&
                 orientationOf(points, v, one.towards, other.towards) > 0;
        });
      }
      const std::size_t begin = ways[static_cast<std::size_t>(v)];
      for (std::size_t i = 0; i < around.size(); ++i)
        (around[i].is_second
             ? way_b
             : way_a)[2 * static_cast<std::size_t>(around[i].edge) + (around[i].is_begin ? 0 : 1)] =
            begin + i;
      ways[static_cast<std::size_t>(v) + 1] = begin + around.size();
    }
  }
  for (std::size_t v = order.size(); v < w; ++v)
    ways[v + 1] = ways[v] + 4;

  std::vector<std::size_t> twin(ways[w]);
  std::vector<Index> origin(ways[w]);
  for (std::size_t v = 0; v < w; ++v)
    std::fill(origin.begin() + static_cast<std::ptrdiff_t>(ways[v]),
              origin.begin() + static_cast<std::ptrdiff_t>(ways[v + 1]), static_cast<Index>(v));
  const auto join = [&twin](std::size_t one, std::size_t other) {
    twin[one] = other;
    twin[other] = one;
  };
  // Around a crossing: on along the first's edge, left of it, back, right of it.
  for (Index e = 0; e < mesh_a.edgeCount(); ++e) {
    std::size_t out = way_a[2 * static_cast<std::size_t>(e)];
    for (std::size_t c = of_a.begin(e); c < of_a.end(e); ++c) {
      const std::size_t begin = ways[static_cast<std::size_t>(nodes_of_a[c])];
      join(out, begin + 2);
      out = begin;
    }
    join(out, way_a[2 * static_cast<std::size_t>(e) + 1]);
  }
  for (Index e = 0; e < mesh_b.edgeCount(); ++e) {
    if (of_b.along[static_cast<std::size_t>(e)] >= 0)
      continue;
    std::size_t out = way_b[2 * static_cast<std::size_t>(e)];
    for (std::size_t x = of_b.begin(e); x < of_b.end(e); ++x) {
      const std::size_t begin = ways[order.size() + x];
      join(out, begin + (from_left[x] != 0 ? 1 : 3));
      out = begin + (from_left[x] != 0 ? 3 : 1);
    }
    join(out, way_b[2 * static_cast<std::size_t>(e) + 1]);
  }

  // The face to the left of a way goes on, where that ends, by the next way clockwise.
  overlay.offsets.push_back(0);
  std::vector<char> is_done(twin.size(), 0);
  for (std::size_t start = 0; start < twin.size(); ++start) {
    if (is_done[start] != 0)
      continue;
    std::size_t way = start;
    do {
      is_done[way] = 1;
      overlay.corners.push_back(origin[way]);
      const std::size_t back = twin[way];
      const auto v = static_cast<std::size_t>(origin[back]);
      way = back == ways[v] ? ways[v + 1] - 1 : back - 1;
    } while (way != start);
    overlay.offsets.push_back(overlay.corners.size());
    if (overlay.corners.size() - overlay.offsets[overlay.offsets.size() - 2] < 3)
      failLost();
  }
  // Euler: else the edges would cross more often than was found, or rotations would be wrong.
  if (w + overlay.offsets.size() - 1 != twin.size() / 2 + 2)
    failLost();
  return overlay;
}

}  // namespace spherical_param::internal
