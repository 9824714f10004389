#include "sphere_overlay.h"

#include "index_loops.h"
#include "sphere_mesh.h"
#include "spherical_param/errors.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numeric>
#include <utility>
#include <vector>

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
  // Coordinates are moved by amounts of which each is smaller than any product of those before it:
  // the last of i, the one before it, the first of i; then those of j; those of k do not count.
  for (const int sign :
       {minorSign(j, k, 0, 1), -minorSign(j, k, 0, 2), minorSign(j, k, 1, 2),
        -minorSign(i, k, 0, 1), signOf(k[0]), -signOf(k[1]), minorSign(i, k, 0, 2), signOf(k[2])})
    if (sign != 0)
      return sign;
  return 1;
}

/// Sign of the determinant of three columns; 0 only if two of them are the same.
int orientationOf(const Positions& points, Index i, Index j, Index k) {
  if (i == j || j == k || k == i)
    return 0;
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

using Corners = std::array<Index, 3>;

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

/// A corner of a face, and the sides of the face before and behind it: 0 to 2 are sides of the
/// first mesh's triangle, 3 to 5 of the second's. Side k of a triangle begins at its corner k.
struct FaceCorner {
  std::uint64_t key;  ///< a vertex; or above all of these, the two half-edges that cross
  int before;
  int behind;
};

/// One of the two meshes, whose vertices are columns of a common list.
struct OverlaidMesh {
  SphereMesh mesh;
  Indexed<Index> number;    ///< column of each vertex
  Indexed<Index> triangle;  ///< of each column: the first that holds it

  OverlaidMesh(const Triangles& triangles, Indexed<Index> numbers, std::size_t columns)
      : mesh(triangles, numbers.size()), number(std::move(numbers)), triangle(columns, -1) {}

  Corners corners(Index t) const {
    const Corners& v = mesh.vertices(t);
    return {number[v[0]], number[v[1]], number[v[2]]};
  }
  Index across(Index t, int side) const { return mesh.neighbor(t, (side + 2) % 3); }
  /// The number of an edge: the lower one of its half-edges, 3 triangle + side.
  std::uint64_t edge(Index t, int side) const {
    const Index other = 3 * across(t, side) + (mesh.oppositeCorner(t, (side + 2) % 3) + 1) % 3;
    return static_cast<std::uint64_t>(std::min(3 * t + side, other));
  }
  std::array<Index, 2> ends(Index edge) const {
    const Corners v = corners(edge / 3);
    return {v[static_cast<std::size_t>(edge % 3)], v[static_cast<std::size_t>((edge + 1) % 3)]};
  }
  void hold(Index column, Index t) {
    if (triangle[column] < 0 || t < triangle[column])
      triangle[column] = t;
  }

  /// Place of a column in the flat triangle that its direction meets.
  SphereLocation place(const Positions& points, Index column) const {
    SphereLocation location;
    location.triangle = triangle[column];
    const Corners v = corners(location.triangle);
    for (std::size_t k = 0; k < 3; ++k)
      location.weights[static_cast<Index>(k)] =
          std::find(v.begin(), v.end(), column) != v.end()
              ? (v[k] == column ? 1.0 : 0.0)
              : std::max(0.0, determinantOf(points, column, v[(k + 1) % 3], v[(k + 2) % 3]));
    location.weights = withSumOne(location.weights);
    return location;
  }
};

/// Place on an edge, as a fraction of the way to its end.
SphereLocation placeOn(Index edge, double fraction) {
  SphereLocation location;
  location.triangle = edge / 3;
  location.weights[edge % 3] = 1.0 - fraction;
  location.weights[(edge + 1) % 3] = fraction;
  return location;
}

/// Finds the faces of an overlay, from each to those beyond its sides.
class OverlayBuilder {
public:
  OverlayBuilder(const Positions& points, OverlaidMesh first, OverlaidMesh second)
      : points_(points), first_(std::move(first)), second_(std::move(second)) {}

  SphereOverlay build() {
    traceFaces();
    std::vector<std::uint64_t> crossings;
    for (const std::uint64_t key : keys_)
      if (key >= kCrossing)
        crossings.push_back(key);
    sortUnique(crossings);
    const std::size_t vertex_count = columnCount(points_);
    const std::size_t node_count = vertex_count + crossings.size();
    if (node_count > std::size_t{1} << 28U)
      throw ComputeError("morphSurfaces: the edges of both meshes cross too often; resample them");
    // Euler: else a triangulation would cover the sphere more than once.
    if (node_count + overlay_.offsets.size() - 1 != keys_.size() / 2 + 2)
      failLost();
    for (const std::uint64_t key : keys_)
      overlay_.corners.push_back(static_cast<Index>(
          key < kCrossing
              ? key
              : vertex_count + static_cast<std::size_t>(
                                   std::lower_bound(crossings.begin(), crossings.end(), key) -
                                   crossings.begin())));
    placeNodes(crossings);
    return std::move(overlay_);
  }

private:
  static constexpr std::uint64_t kCrossing = std::uint64_t{1} << 32U;

  /// On which side of the sides of a triangle the corners of another are.
  using Sides = std::array<std::array<int, 3>, 3>;
  Sides sidesOf(const Corners& of, const Corners& other) const {
    Sides sides{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        sides[k][j] = orientationOf(points_, of[k], of[(k + 1) % 3], other[j]);
    return sides;
  }

  /// Finds the corners of what two triangles have in common, in any order.
  void findCorners(Index first, Index second) {
    face_.clear();
    const Corners a = first_.corners(first);
    const Corners b = second_.corners(second);
    const Sides of_a = sidesOf(a, b);
    const Sides of_b = sidesOf(b, a);
    const auto holds = [](const Sides& sides, std::size_t j) {
      return sides[0][j] > 0 && sides[1][j] > 0 && sides[2][j] > 0;
    };
    for (int k = 0; k < 3; ++k) {
      const auto u = static_cast<std::size_t>(k);
      const auto shared = std::find(b.begin(), b.end(), a[u]);
      if (shared != b.end())
        addShared(k, static_cast<int>(shared - b.begin()), a, b, of_a, of_b);
      else if (holds(of_b, u))
        face_.push_back({static_cast<std::uint64_t>(a[u]), (k + 2) % 3, k});
      if (holds(of_a, u))
        face_.push_back({static_cast<std::uint64_t>(b[u]), 3 + (k + 2) % 3, 3 + k});
      for (int j = 0; j < 3; ++j) {
        const auto w = static_cast<std::size_t>(j);
        const int begin = of_a[u][w];
        // The end is on the other side; and so they are not antipodes that cross.
        if (begin * of_a[u][(w + 1) % 3] >= 0 || of_b[w][u] != -begin ||
            of_b[w][(u + 1) % 3] != begin)
          continue;
        const std::uint64_t key = kCrossing * (first_.edge(first, k) + 1) + second_.edge(second, j);
        face_.push_back(begin < 0 ? FaceCorner{key, k, 3 + j} : FaceCorner{key, 3 + j, k});
      }
    }
  }

  /// Adds corner k of the first triangle, which is corner j of the second, if their wedges overlap.
  void addShared(int k, int j, const Corners& a, const Corners& b, const Sides& of_a,
                 const Sides& of_b) {
    const auto corner = [](int i) { return static_cast<std::size_t>(i % 3); };
    // Whether the wedge of a triangle at a corner holds the other's corner.
    const auto holds = [&corner](const Sides& sides, int at, int other) {
      return sides[corner(at)][corner(other)] > 0 && sides[corner(at + 2)][corner(other)] > 0;
    };
    // The inner one of the sides that leave the corner, and of those that lead to it.
    const auto inner = [&](int step, int side_a, int side_b) {
      if (holds(of_a, k, j + step))
        return 3 + side_b % 3;
      return holds(of_b, j, k + step) || a[corner(k + step)] == b[corner(j + step)] ? side_a % 3
                                                                                    : -1;
    };
    const int behind = inner(1, k, j);
    const int before = inner(2, k + 2, j + 2);
    if (behind >= 0 && before >= 0)
      face_.push_back({static_cast<std::uint64_t>(a[corner(k)]), before, behind});
  }

  /// Adds a face to the overlay.
  void addFace(Index first, Index second) {
    findCorners(first, second);
    if (face_.size() < 3)
      failLost();
    std::size_t at = 0;
    for (std::size_t i = 0; i < face_.size(); ++i) {
      const FaceCorner corner = face_[at];
      keys_.push_back(corner.key);
      if (corner.key < kCrossing) {
        first_.hold(static_cast<Index>(corner.key), first);
        second_.hold(static_cast<Index>(corner.key), second);
      }
      at = static_cast<std::size_t>(
          std::find_if(face_.begin(), face_.end(),
                       [&](const FaceCorner& next) { return next.before == corner.behind; }) -
          face_.begin());
      if (at == face_.size() || (at == 0) != (i + 1 == face_.size()))
        failLost();
    }
    overlay_.first_triangles.push_back(first);
    overlay_.second_triangles.push_back(second);
    overlay_.offsets.push_back(indexCount(keys_));
  }

  /// Some triangle of the second mesh that has a face with one of the first.
  Index partnerOf(Index first) {
    for (Index t = 0; t < second_.mesh.size(); ++t) {
      findCorners(first, t);
      if (face_.size() >= 3)
        return t;
    }
    failLost();
  }

  void traceFaces() {
    // Of each triangle of the first mesh: one of the second to begin with.
    Indexed<Index> begins(first_.mesh.slotCount(), -1);
    Indexed<Index> visited_by(second_.mesh.slotCount(), -1);
    std::vector<Index> waiting{0};
    begins[0] = partnerOf(0);
    std::vector<Index> inside;
    while (!waiting.empty()) {
      const Index first = waiting.back();
      waiting.pop_back();
      const auto visit = [&](Index second) {
        if (visited_by[second] == first)
          return;
        visited_by[second] = first;
        inside.push_back(second);
      };
      visit(begins[first]);
      while (!inside.empty()) {
        const Index second = inside.back();
        inside.pop_back();
        addFace(first, second);
        for (const FaceCorner& corner : face_) {
          if (corner.behind >= 3) {
            visit(second_.across(second, corner.behind - 3));
            continue;
          }
          const Index next = first_.across(first, corner.behind);
          if (begins[next] < 0) {
            begins[next] = beyond(first, corner.behind, second);
            waiting.push_back(next);
          }
        }
      }
    }
  }

  /// The triangle of the second mesh beyond a side of the first: the same, unless it is a side of
  /// both.
  Index beyond(Index first, int side, Index second) const {
    const auto [begin, end] = first_.ends(3 * first + side);
    for (int j = 0; j < 3; ++j)
      if (second_.ends(3 * second + j) == std::array{begin, end})
        return second_.across(second, j);
    return second;
  }

  void placeNodes(const std::vector<std::uint64_t>& crossings) {
    const auto n = static_cast<Index>(points_.cols());
    overlay_.directions.resize(3, n + indexCount(crossings));
    overlay_.directions.leftCols(n) = points_;
    for (Index v = 0; v < n; ++v) {
      overlay_.first.push_back(first_.place(points_, v));
      overlay_.second.push_back(second_.place(points_, v));
    }
    for (const std::uint64_t key : crossings) {
      const auto first = static_cast<Index>(key / kCrossing - 1);
      const auto second = static_cast<Index>(key % kCrossing);
      const auto ends = first_.ends(first);
      const auto [of_first, of_second] = crossingOf(points_, ends, second_.ends(second));
      overlay_.directions.col(indexCount(overlay_.first)) =
          ((1.0 - of_first) * points_.col(ends[0]) + of_first * points_.col(ends[1])).normalized();
      overlay_.first.push_back(placeOn(first, of_first));
      overlay_.second.push_back(placeOn(second, of_second));
    }
  }

  const Positions& points_;
  OverlaidMesh first_;
  OverlaidMesh second_;
  std::vector<FaceCorner> face_;
  std::vector<std::uint64_t> keys_;  ///< of the corners of all faces
  SphereOverlay overlay_;
};

}  // namespace

SphereOverlay overlaySpheres(const Positions& first, const Triangles& first_triangles,
                             const Positions& second, const Triangles& second_triangles,
                             const Indexed<Index>& partner) {
  // The vertices of both meshes in one numbering: those of the first, then others of the second.
  auto count = static_cast<Index>(first.cols());
  Indexed<Index> of_first(columnCount(first));
  std::iota(of_first.begin(), of_first.end(), 0);
  Indexed<Index> of_second = partner;
  for (Index& number : of_second)
    if (number < 0)
      number = count++;
  Positions points(3, count);
  points.leftCols(first.cols()) = first;
  points(Eigen::all, of_second) = second;
  const auto columns = static_cast<std::size_t>(count);
  return OverlayBuilder(points, {first_triangles, std::move(of_first), columns},
                        {second_triangles, std::move(of_second), columns})
      .build();
}

}  // namespace spherical_param::internal
