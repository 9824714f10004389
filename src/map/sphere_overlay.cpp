#include "sphere_overlay.h"

#include "index_loops.h"
#include "space_filling_curve.h"
#include "spherical_param/errors.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Vector3d;

int minorSign(const Vector3d& u, const Vector3d& v, int a, int b) {
  return orientation2d({u[a], u[b]}, {v[a], v[b]}, Eigen::Vector2d::Zero());
}

int signOf(double x) {
  return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
}

/// For i < j < k: the sign of the first coefficient that does not vanish of the determinant, as a
/// polynomial in what the coordinates are moved by.
int perturbedSign(const Vector3d& i, const Vector3d& j, const Vector3d& k) {
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
  const Vector3d a = points.col(i);
  const Vector3d ab = points.col(j) - points.col(i);
  const Vector3d ac = points.col(k) - points.col(i);
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

/// Place on an edge, as a fraction of the way to its second end.
SphereLocation placeOn(const ArcMesh& mesh, Index edge, double fraction) {
  const Index corner = mesh.cornerOppositeTo(edge);
  SphereLocation location;
  location.triangle = corner / 3;
  location.weights[(corner % 3 + 1) % 3] = 1.0 - fraction;
  location.weights[(corner % 3 + 2) % 3] = fraction;
  return location;
}

SphereLocation placeAtCorner(Index triangle, Index corner) {
  SphereLocation location;
  location.triangle = triangle;
  location.weights[corner] = 1.0;
  return location;
}

/// Both fractions at which two arcs cross that are known to do so.
std::array<double, 2> crossingOf(const Positions& points, const std::array<Index, 2>& a,
                                 const std::array<Index, 2>& b) {
  const auto fraction = [&points](const std::array<Index, 2>& of,
                                  const std::array<Index, 2>& other) {
    const double from = std::abs(determinantOf(points, other[0], other[1], of[0]));
    const double to = std::abs(determinantOf(points, other[0], other[1], of[1]));
    return from + to > 0.0 ? from / (from + to) : -1.0;
  };
  std::array<double, 2> fractions{fraction(a, b), fraction(b, a)};
  if (fractions[0] >= 0.0 && fractions[1] >= 0.0)
    return fractions;
  // On one great circle: the middle of what they have in common.
  const auto along = [&points](const std::array<Index, 2>& of, const Vector3d& place) {
    const Vector3d step = points.col(of[1]) - points.col(of[0]);
    return std::clamp((place - points.col(of[0])).dot(step) / step.squaredNorm(), 0.0, 1.0);
  };
  const double middle = 0.5 * (along(a, points.col(b[0])) + along(a, points.col(b[1])));
  const Vector3d place = (1.0 - middle) * points.col(a[0]) + middle * points.col(a[1]);
  return {middle, along(b, place.normalized())};
}

/// The edges of one mesh that each edge of another crosses, in order.
struct Crossings {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> edges;
  std::vector<Index> along;  ///< the edge of the other mesh that it is itself; -1: none

  Index begin(Index edge) const { return static_cast<Index>(entry(offsets, edge)); }
  Index end(Index edge) const { return begin(edge + 1); }
  bool isAlong(Index edge) const { return entry(along, edge) >= 0; }
};

/// \param places of the vertices of `mesh` in `through`
Crossings crossingsOf(const ArcMesh& mesh, const ArcMesh& through,
                      const std::vector<SphereLocation>& places, int threads) {
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
          ends[0], ends[1], places[static_cast<std::size_t>(ends[0])].triangle, of_block[block]);
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
void ascend(double& fraction, double& least) {
  fraction = least = std::max(fraction, least);
}

}  // namespace

int orientationOf(const Positions& points, Index i, Index j, Index k) {
  const int sign = determinantSign(points.col(i), points.col(j), points.col(k));
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
    : points_(points), triangles_(triangles), across_(3 * columnCount(triangles)),
      edge_of_(across_.size()), corner_at_(columnCount(points), -1) {
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
  for (Index t = 0; t < triangles.cols(); ++t)
    for (Index k = 0; k < 3; ++k) {
      const Index begin = vertex(t, (k + 1) % 3);
      const Index end = vertex(t, (k + 2) % 3);
      sides.push_back({std::min(begin, end), std::max(begin, end), 3 * t + k});
      Index& corner = corner_at_[vertex(t, k)];
      if (corner < 0)
        corner = 3 * t + k;
    }
  std::sort(sides.begin(), sides.end());
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2) {
    const Index left = sides[s].corner;
    const Index right = sides[s + 1].corner;
    across_[left] = right;
    across_[right] = left;
    edge_of_[left] = edge_of_[right] = edgeCount();
    edge_corner_.push_back(left);
  }
}

std::array<Index, 2> ArcMesh::ends(Index edge) const {
  const Index corner = edge_corner_[edge];
  return {vertex(corner / 3, (corner % 3 + 1) % 3), vertex(corner / 3, (corner % 3 + 2) % 3)};
}

bool ArcMesh::leavesBetween(Index from, Index to, Index right, Index left) const {
  return orientationOf(points_, from, right, to) > 0 && orientationOf(points_, from, left, to) < 0;
}

ArcMesh::Exit ArcMesh::leaveVertex(Index from, Index to) const {
  const Index first = corner_at_[from];
  Index around = first;
  do {
    const Index t = around / 3;
    const Index k = around % 3;
    const Index right = vertex(t, (k + 1) % 3);
    const Index left = vertex(t, (k + 2) % 3);
    if (right == to || left == to) {
      const Index opposite = 3 * t + (k + (right == to ? 2 : 1)) % 3;
      return {{false, edge_of_[opposite], -1}, -1};
    }
    if (leavesBetween(from, to, right, left)) {
      if (orientationOf(points_, right, left, to) > 0)
        return {{false, -1, t}, -1};
      return {{}, around};
    }
    around = nextAround(around);
  } while (around != first);
  return {{true, -1, -1}, -1};
}

ArcMesh::Exit ArcMesh::leaveTriangle(Index triangle, Index from, Index to) const {
  bool is_inside = true;
  Index corner = -1;
  for (Index k = 0; k < 3; ++k) {
    if (vertex(triangle, k) == to)
      return {{}, -1};
    const Index right = vertex(triangle, (k + 1) % 3);
    const Index left = vertex(triangle, (k + 2) % 3);
    if (right == to || left == to)
      continue;
    if (orientationOf(points_, right, left, to) < 0) {
      is_inside = false;
      if (leavesBetween(from, to, right, left))
        corner = 3 * triangle + k;
    }
  }
  if (is_inside)
    return {{false, -1, triangle}, -1};
  return {{corner < 0, -1, -1}, corner};
}

ArcMesh::Walk ArcMesh::walk(Index from, Index to, Index start, std::vector<Index>& crossed) const {
  const Exit exit = isVertex(from) ? leaveVertex(from, to) : leaveTriangle(start, from, to);
  Index corner = exit.corner;
  if (corner < 0)
    return exit.walk;
  for (std::size_t steps = 0; steps <= across_.size(); ++steps) {
    crossed.push_back(edge_of_[corner]);
    const Index entry = across_[corner];
    const Index t = entry / 3;
    const Index k = entry % 3;
    // Seen from this triangle the side runs the other way round.
    const Index left = vertex(t, (k + 1) % 3);
    const Index right = vertex(t, (k + 2) % 3);
    const Index apex = vertex(t, k);
    if (apex == to)
      return {};
    const bool is_right = orientationOf(points_, from, to, apex) > 0;
    corner = 3 * t + (k + (is_right ? 1 : 2)) % 3;
    if (orientationOf(points_, is_right ? right : apex, is_right ? apex : left, to) > 0)
      return {false, -1, t};
  }
  return {true, -1, -1};
}

Indexed<SphereLocation> locateAll(const Positions& points, const Triangles& triangles,
                                  Eigen::Index first) {
  const ArcMesh mesh(points, triangles);
  // In an order in which neighbours are near each other: each walk is short.
  const std::vector<Index> order = mortonOrder(points.rightCols(points.cols() - first));
  Indexed<SphereLocation> locations(order.size());
  std::vector<Index> crossed;
  Index last = 0;
  for (const Index q : order) {
    const Index point = static_cast<Index>(first) + q;
    if (mesh.isVertex(point)) {
      mesh.forEachEdgeAt(point, [&](Index edge, bool, Index) {
        const Index corner = mesh.cornerOppositeTo(edge);
        const Index second = (corner % 3 + 2) % 3;
        const Index k = mesh.vertex(corner / 3, second) == point ? second : (corner % 3 + 1) % 3;
        locations[q] = placeAtCorner(corner / 3, k);
      });
      last = locations[q].triangle;
      continue;
    }
    crossed.clear();
    const ArcMesh::Walk walk = mesh.walk(mesh.vertex(last, 0), point, -1, crossed);
    if (walk.lost || walk.triangle < 0)
      failLost();
    last = walk.triangle;
    locations[q] = placeIn(points, triangles, last, point);
  }
  return locations;
}

namespace {

/// The vertices of two meshes in one numbering: those of the first, then the others of the second.
struct CommonVertices {
  Positions points;
  Triangles second_triangles;  ///< of the second mesh, renumbered

  CommonVertices(const Positions& first, const Positions& second, const Triangles& triangles,
                 const std::vector<Index>& partner) {
    Indexed<Index> number(partner.begin(), partner.end());
    auto count = static_cast<Index>(first.cols());
    for (Index& i : number)
      if (i < 0)
        i = count++;
    points.resize(3, count);
    points.leftCols(first.cols()) = first;
    points(Eigen::all, number) = second;
    second_triangles = triangles.unaryExpr([&](Index v) { return number[v]; });
  }
};

/// Builds the overlay as a map of half-edges: its nodes are the vertices of both meshes and the
/// crossings of their edges, each half-edge leaves a node and has a twin, and the half-edges of a
/// node are numbered counter-clockwise.
class OverlayBuilder {
public:
  OverlayBuilder(const CommonVertices& vertices, const Triangles& first_triangles, int threads)
      : points_(vertices.points), triangles_{&first_triangles, &vertices.second_triangles},
        threads_(threads), vertex_count_(static_cast<Index>(points_.cols())),
        mesh_a_(points_, first_triangles), mesh_b_(points_, vertices.second_triangles) {}

  SphereOverlay build() {
    locateVertices();
    findCrossings();
    matchCrossings();
    placeCrossings();
    numberHalfEdges();
    joinTwins();
    traceFaces();
    return std::move(overlay_);
  }

private:
  void locateVertices() {
    const std::array<Indexed<SphereLocation>*, 2> places{&overlay_.first, &overlay_.second};
    forEachTask(2, std::min(threads_, 2),
                [&](std::size_t m) { *places[m] = locateAll(points_, *triangles_[m], 0); });
  }

  void findCrossings() {
    of_b_ = crossingsOf(mesh_b_, mesh_a_, overlay_.first, threads_);
    of_a_ = crossingsOf(mesh_a_, mesh_b_, overlay_.second, threads_);
    if (of_a_.edges.size() != of_b_.edges.size())
      failLost();
    const std::size_t node_count = columnCount(points_) + of_b_.edges.size();
    // Half-edges, four at a crossing, have an Index.
    if (node_count > std::size_t{1} << 28U)
      throw ComputeError("morphSurfaces: the edges of both meshes cross too often; resample them");
    node_count_ = static_cast<Index>(node_count);
    overlay_.first.resize(node_count);
    overlay_.second.resize(node_count);
  }

  /// Finds the node of each crossing on the edges of the first mesh: nodes are numbered along the
  /// edges of the second.
  void matchCrossings() {
    Indexed<std::pair<Index, Index>> by_edge(of_b_.edges.size());  // edge of the second, node
    Indexed<Index> free;  // of each edge of the first, where the next goes
    for (Index e = 0; e < mesh_a_.edgeCount(); ++e)
      free.push_back(of_a_.begin(e));
    for (Index e = 0; e < mesh_b_.edgeCount(); ++e)
      for (Index c = of_b_.begin(e); c < of_b_.end(e); ++c) {
        const Index a = entry(of_b_.edges, c);
        if (free[a] == of_a_.end(a))
          failLost();
        by_edge[free[a]++] = {e, vertex_count_ + c};
      }
    nodes_of_a_.resize(by_edge.size());
    for (Index e = 0; e < mesh_a_.edgeCount(); ++e) {
      const auto first = by_edge.begin() + of_a_.begin(e);
      const auto last = by_edge.begin() + of_a_.end(e);
      for (Index c = of_a_.begin(e); c < of_a_.end(e); ++c) {
        const Index crossed = entry(of_a_.edges, c);
        const auto found = std::lower_bound(first, last, std::pair(crossed, Index{0}));
        if (found == last || found->first != crossed)
          failLost();
        nodes_of_a_[c] = found->second;
      }
    }
  }

  void placeCrossings() {
    Indexed<double> fraction_of_a(nodes_of_a_.size());
    Indexed<double> fraction_of_b(nodes_of_a_.size());
    from_left_.resize(nodes_of_a_.size());
    for (Index e = 0; e < mesh_a_.edgeCount(); ++e) {
      const std::array<Index, 2> ends = mesh_a_.ends(e);
      double least = 0.0;
      for (Index c = of_a_.begin(e); c < of_a_.end(e); ++c) {
        const Index node = nodes_of_a_[c];
        const Index x = node - vertex_count_;
        const std::array<Index, 2> other = mesh_b_.ends(entry(of_a_.edges, c));
        const std::array<double, 2> fractions = crossingOf(points_, ends, other);
        fraction_of_a[x] = fractions[0];
        fraction_of_b[x] = fractions[1];
        ascend(fraction_of_a[x], least);
        from_left_[x] = orientationOf(points_, ends[0], ends[1], other[0]) > 0 ? 1 : 0;
        overlay_.first[node] = placeOn(mesh_a_, e, fraction_of_a[x]);
      }
    }
    overlay_.directions.resize(3, node_count_);
    overlay_.directions.leftCols(points_.cols()) = points_;
    for (Index e = 0; e < mesh_b_.edgeCount(); ++e) {
      double least = 0.0;
      for (Index x = of_b_.begin(e); x < of_b_.end(e); ++x) {
        ascend(fraction_of_b[x], least);
        overlay_.second[vertex_count_ + x] = placeOn(mesh_b_, e, fraction_of_b[x]);
        const std::array<Index, 2> ends = mesh_a_.ends(entry(of_b_.edges, x));
        overlay_.directions.col(vertex_count_ + x) =
            ((1.0 - fraction_of_a[x]) * points_.col(ends[0]) +
             fraction_of_a[x] * points_.col(ends[1]))
                .normalized();
      }
    }
  }

  /// A half-edge that leaves a vertex.
  struct Spoke {
    Index edge;
    bool is_second, is_begin;
    Index towards;
  };

  /// The half-edges of a vertex, counter-clockwise.
  void findSpokes(Index v, std::vector<Spoke>& spokes) const {
    spokes.clear();
    if (mesh_a_.isVertex(v))
      mesh_a_.forEachEdgeAt(v, [&](Index edge, bool is_begin, Index towards) {
        spokes.push_back({edge, false, is_begin, towards});
      });
    if (!mesh_b_.isVertex(v))
      return;
    mesh_b_.forEachEdgeAt(v, [&](Index edge, bool is_begin, Index towards) {
      if (!of_b_.isAlong(edge))
        spokes.push_back({edge, true, is_begin, towards});
    });
    if (!mesh_a_.isVertex(v))
      return;
    const Index zero = spokes[0].towards;
    const auto half = [&](const Spoke& spoke) {
      return spoke.towards != zero && orientationOf(points_, v, zero, spoke.towards) < 0;
    };
    std::sort(spokes.begin() + 1, spokes.end(), [&](const Spoke& one, const Spoke& other) {
      const bool half_of_one = half(one);
      const bool half_of_other = half(other);
      if (half_of_one != half_of_other)
        return half_of_other;
      return one.towards != other.towards &&
             orientationOf(points_, v, one.towards, other.towards) > 0;
    });
  }

  void numberHalfEdges() {
    ends_of_a_.resize(of_a_.along.size());
    ends_of_b_.resize(of_b_.along.size());
    std::vector<Spoke> spokes;
    for (Index v = 0; v < vertex_count_; ++v) {
      findSpokes(v, spokes);
      offsets_.push_back(indexCount(origin_));
      for (const Spoke& spoke : spokes) {
        std::array<Index, 2>& ends = (spoke.is_second ? ends_of_b_ : ends_of_a_)[spoke.edge];
        (spoke.is_begin ? ends[0] : ends[1]) = indexCount(origin_);
        origin_.push_back(v);
      }
    }
    for (Index v = vertex_count_; v < node_count_; ++v) {
      offsets_.push_back(indexCount(origin_));
      origin_.insert(origin_.end(), 4, v);
    }
    offsets_.push_back(indexCount(origin_));
  }

  /// Around a crossing: on along the first's edge, left of it, back, right of it.
  void joinTwins() {
    twin_.resize(origin_.size());
    const auto join = [this](Index one, Index other) {
      twin_[one] = other;
      twin_[other] = one;
    };
    for (Index e = 0; e < mesh_a_.edgeCount(); ++e) {
      Index out = ends_of_a_[e][0];
      for (Index c = of_a_.begin(e); c < of_a_.end(e); ++c) {
        const Index begin = offsets_[nodes_of_a_[c]];
        join(out, begin + 2);
        out = begin;
      }
      join(out, ends_of_a_[e][1]);
    }
    for (Index e = 0; e < mesh_b_.edgeCount(); ++e) {
      if (of_b_.isAlong(e))
        continue;
      Index out = ends_of_b_[e][0];
      for (Index x = of_b_.begin(e); x < of_b_.end(e); ++x) {
        const Index begin = offsets_[vertex_count_ + x];
        join(out, begin + (from_left_[x] != 0 ? 1 : 3));
        out = begin + (from_left_[x] != 0 ? 3 : 1);
      }
      join(out, ends_of_b_[e][1]);
    }
  }

  /// The face to the left of a half-edge continues, where that ends, by the next one clockwise.
  void traceFaces() {
    overlay_.offsets.push_back(0);
    Indexed<char> is_done(twin_.size(), 0);
    for (Index start = 0; start < indexCount(twin_); ++start) {
      if (is_done[start] != 0)
        continue;
      Index half_edge = start;
      do {
        is_done[half_edge] = 1;
        overlay_.corners.push_back(origin_[half_edge]);
        const Index back = twin_[half_edge];
        const Index v = origin_[back];
        half_edge = back == offsets_[v] ? offsets_[v + 1] - 1 : back - 1;
      } while (half_edge != start);
      overlay_.offsets.push_back(overlay_.corners.size());
      if (overlay_.corners.size() - overlay_.offsets[overlay_.offsets.size() - 2] < 3)
        failLost();
    }
    // Euler: else the edges would cross more often than was found, or rotations would be wrong.
    if (node_count_ + indexCount(overlay_.offsets) - 1 != indexCount(twin_) / 2 + 2)
      failLost();
  }

  const Positions& points_;
  std::array<const Triangles*, 2> triangles_;
  int threads_;
  Index vertex_count_;
  Index node_count_ = 0;
  ArcMesh mesh_a_;
  ArcMesh mesh_b_;
  Crossings of_a_;
  Crossings of_b_;
  Indexed<Index> nodes_of_a_;  ///< crossings in the order along the edges of the first mesh
  Indexed<char> from_left_;    ///< whether the second's edge comes from left of the first's
  Indexed<Index> offsets_;     ///< nodes + 1: the half-edges of each node
  Indexed<std::array<Index, 2>> ends_of_a_;  ///< half-edges at both ends of the first's edges
  Indexed<std::array<Index, 2>> ends_of_b_;  ///< the same of the second mesh
  Indexed<Index> twin_;                      ///< of each half-edge
  Indexed<Index> origin_;                    ///< the node that each half-edge leaves
  SphereOverlay overlay_;
};

}  // namespace

SphereOverlay overlaySpheres(const Positions& first, const Triangles& first_triangles,
                             const Positions& second, const Triangles& second_triangles,
                             const std::vector<Index>& partner, int threads) {
  const CommonVertices vertices(first, second, second_triangles, partner);
  return OverlayBuilder(vertices, first_triangles, threads).build();
}

}  // namespace spherical_param::internal
