#pragma once

#include "spherical_param/execution.h"
#include "spherical_param/types.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace spherical_param::internal {}

/// Clouds, brute-force oracles and checks that the tests share. Everything is recomputed here from
/// the output alone, without the code under test.
namespace spherical_param::test {

using namespace internal;  // tests see the inside

constexpr double kPi = 3.14159265358979323846;

/// The points place(0), ..., place(n - 1).
template <typename Place>
Positions pointsAt(Index n, const Place& place) {
  Positions points(3, n);
  for (Index i = 0; i < n; ++i)
    points.col(i) = place(i);
  return points;
}

/// Points one beside the other.
inline Positions positionsOf(const std::vector<Eigen::Vector3d>& points) {
  return pointsAt(static_cast<Index>(points.size()),
                  [&](Index i) { return points[static_cast<std::size_t>(i)]; });
}

/// The places (i, j) of a grid, row after row.
template <typename Place>
Positions gridOf(int rows, int columns, const Place& place) {
  return pointsAt(rows * columns, [&](Index i) { return place(i / columns, i % columns); });
}

/// A point of the unit circle around the z axis, of some radius and height.
inline Eigen::Vector3d onCircle(double angle, double radius = 1.0, double z = 0.0) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// n points spread evenly over the unit sphere (golden-angle spiral).
inline Positions spiralSphere(Index n) {
  return pointsAt(n, [=](Index i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    return onCircle(kPi * (3.0 - std::sqrt(5.0)) * i, std::sqrt(1.0 - z * z), z);
  });
}

/// n independent random points on the unit sphere.
inline Positions randomSphere(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return pointsAt(n, [&](Index) {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  });
}

/// Random points in a cap of the given radius around a pole.
inline Positions cap(Index n, double radius, const Eigen::Vector3d& pole, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-radius, radius);
  return pointsAt(n, [&](Index) {
    return (pole + Eigen::Vector3d(uniform(random), uniform(random), uniform(random))).normalized();
  });
}

/// n independent random points in the cube [-1, 1]^3.
inline Positions randomCube(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Positions::NullaryExpr(3, n, [&] { return uniform(random); });
}

/// The integer points of a box from the origin on.
inline std::vector<Eigen::Vector3i> latticeOf(const Eigen::Vector3i& size) {
  std::vector<Eigen::Vector3i> points;
  for (int i = 0; i < size.x(); ++i)
    for (int j = 0; j < size.y(); ++j)
      for (int k = 0; k < size.z(); ++k)
        points.emplace_back(i, j, k);
  return points;
}

/// The m^3 - (m - 2)^3 grid points on the surface of the cube [0, 1]^3: full of ties.
inline Positions cubeGrid(int m) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3i& p : latticeOf({m, m, m}))
    if (p.minCoeff() == 0 || p.maxCoeff() == m - 1)
      points.emplace_back(p.cast<double>() / (m - 1));
  return positionsOf(points);
}

/// Independent normal noise on each coordinate.
inline Positions withNoise(Positions points, double sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  for (double& coordinate : points.reshaped())
    coordinate += normal(random);
  return points;
}

template <typename... More>
Positions horizontally(const Positions& a, const Positions& b, const More&... more) {
  Positions result(3, a.cols() + b.cols());
  result << a, b;
  if constexpr (sizeof...(more) > 0)
    return horizontally(result, more...);
  return result;
}

/// Along x.
inline Positions movedTo(double x, const Positions& points) {
  return points.colwise() + Eigen::Vector3d(x, 0.0, 0.0);
}

/// The numbers from `begin` to `end`.
inline std::vector<Index> range(Eigen::Index begin, Eigen::Index end) {
  std::vector<Index> result(static_cast<std::size_t>(end - begin));
  std::iota(result.begin(), result.end(), static_cast<Index>(begin));
  return result;
}

/// The numbers from 0 to n in a random order.
inline std::vector<Index> shuffledRange(Eigen::Index n, std::uint64_t seed) {
  std::vector<Index> result = range(0, n);
  std::shuffle(result.begin(), result.end(), std::mt19937_64(seed));
  return result;
}

/// Row i of a graph, or list i of neighbour lists.
inline std::vector<Index> rowOf(const std::vector<std::size_t>& offsets,
                                const std::vector<Index>& indices, Index i) {
  const auto row = static_cast<std::size_t>(i);
  return {indices.begin() + static_cast<std::ptrdiff_t>(offsets[row]),
          indices.begin() + static_cast<std::ptrdiff_t>(offsets[row + 1])};
}
inline std::vector<Index> rowOf(const NeighborLists& lists, Index i) {
  return rowOf(lists.offsets, lists.indices, i);
}

/// The sides of triangles, from each corner to the next.
inline std::vector<std::pair<Index, Index>> sidesOf(const Triangles& triangles) {
  std::vector<std::pair<Index, Index>> sides;
  for (const auto& t : triangles.colwise())
    for (int k = 0; k < 3; ++k)
      sides.emplace_back(t[k], t[(k + 1) % 3]);
  return sides;
}

/// The k nearest other points of each point, by brute force; ties by index.
inline NeighborLists bruteForceNeighbors(const Positions& points, int k) {
  NeighborLists lists;
  const auto n = static_cast<Index>(points.cols());
  std::vector<std::pair<double, Index>> others;
  for (Index i = 0; i < n; ++i) {
    others.clear();
    for (Index j = 0; j < n; ++j)
      if (j != i)
        others.emplace_back((points.col(i) - points.col(j)).squaredNorm(), j);
    const auto count = std::min<std::ptrdiff_t>(k, static_cast<std::ptrdiff_t>(others.size()));
    std::partial_sort(others.begin(), others.begin() + count, others.end());
    for (std::ptrdiff_t c = 0; c < count; ++c)
      lists.indices.push_back(others[static_cast<std::size_t>(c)].second);
    lists.offsets.push_back(lists.indices.size());
  }
  return lists;
}

/// Makes a search by brute force among some of the points, which must outlive it.
inline NeighborSearchFactory bruteForceFactory(const Positions& points) {
  return [&points](const std::vector<Index>& some) -> NeighborSearch {
    return [&points, some](const std::vector<Index>& queries, int count) {
      const NeighborLists all = bruteForceNeighbors(points(Eigen::all, some), count);
      NeighborLists answer;
      for (const Index query : queries) {
        const auto place = std::lower_bound(some.begin(), some.end(), query) - some.begin();
        for (const Index near : rowOf(all, static_cast<Index>(place)))
          answer.indices.push_back(some[static_cast<std::size_t>(near)]);
        answer.offsets.push_back(answer.indices.size());
      }
      return answer;
    };
  };
}

/// The same among all of them.
inline NeighborSearch bruteForceSearch(const Positions& points) {
  return bruteForceFactory(points)(range(0, points.cols()));
}

/// Whether the triangles are a closed, consistently oriented, edge- and vertex-manifold surface
/// over exactly the vertices [0, n): every directed edge once and its reverse once, the link of
/// every vertex one cycle, V - E + F = 2 pieces - 2 genus.
inline bool isSurfaceOverAll(const Triangles& triangles, Index n, Index genus, Index pieces = 1) {
  std::map<std::pair<Index, Index>, Index> third;  // of the triangle left of a directed edge
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles(k, t);
      const Index b = triangles((k + 1) % 3, t);
      if (a == b || a < 0 || a >= n || !third.insert({{a, b}, triangles((k + 2) % 3, t)}).second)
        return false;
    }
  for (const auto& [edge, apex] : third)
    if (third.count({edge.second, edge.first}) == 0)
      return false;
  for (Index v = 0; v < n; ++v) {
    const auto first = third.lower_bound({v, 0});
    const auto degree = std::distance(first, third.lower_bound({v + 1, 0}));
    if (degree == 0)
      return false;
    std::ptrdiff_t steps = 0;
    Index around = first->first.second;
    do {
      around = third.at({v, around});
      ++steps;
    } while (around != first->first.second && steps <= degree);
    if (steps != degree)
      return false;
  }
  std::set<Index> seen;
  Index found_pieces = 0;
  for (Index first = 0; first < n; ++first) {
    if (!seen.insert(first).second)
      continue;
    ++found_pieces;
    std::vector<Index> todo{first};
    while (!todo.empty()) {
      const Index v = todo.back();
      todo.pop_back();
      for (auto at = third.lower_bound({v, 0}); at != third.end() && at->first.first == v; ++at)
        if (seen.insert(at->first.second).second)
          todo.push_back(at->first.second);
    }
  }
  return found_pieces == pieces &&
         n - static_cast<Index>(third.size() / 2) + static_cast<Index>(triangles.cols()) ==
             2 * pieces - 2 * genus;
}

inline bool isSphereOverAll(const Triangles& triangles, Index n) {
  return isSurfaceOverAll(triangles, n, 0);
}

/// The triangles as a sorted list, each begun at its lowest vertex: equal for equal meshes.
inline std::vector<std::array<Index, 3>> canonical(const Triangles& triangles) {
  std::vector<std::array<Index, 3>> result;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    std::array<Index, 3> triangle{triangles(0, t), triangles(1, t), triangles(2, t)};
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
    result.push_back(triangle);
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Whether there are some, all in [0, 1].
inline bool areFractions(const std::vector<double>& fractions) {
  return !fractions.empty() && std::all_of(fractions.begin(), fractions.end(), [](double fraction) {
    return fraction >= 0.0 && fraction <= 1.0;
  });
}

/// The results of run(0) ... run(count - 1), each computed in a thread of its own at the same time.
template <typename Run>
auto runTogether(std::size_t count, const Run& run) {
  std::vector<decltype(run(std::size_t{0}))> results(count);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i)
    threads.emplace_back([&, i] { results[i] = run(i); });
  for (std::thread& thread : threads)
    thread.join();
  return results;
}

/// Signed volume, by plain summation of determinants.
inline double volumeOf(const Positions& points, const Triangles& triangles) {
  double sum = 0.0;
  for (const auto& corners : triangles.colwise())
    sum += Eigen::Matrix3d(points(Eigen::all, corners)).determinant();
  return sum / 6.0;
}

struct Mesh {
  Positions points;
  Triangles triangles;
};

/// A closed tube of radius 1 whose axis is an arc, with its true triangles.
///
/// \param length of the axis, in radii, besides the two ends.
/// \param turn   [rad] that the axis bends by in all; 0 is straight.
/// \param ring   points around.
inline Mesh bentTube(double length, double turn, int ring) {
  const double spacing = 2.0 * kPi / ring;
  const int rings = std::max(2, static_cast<int>(length / (spacing * std::sqrt(3.0) / 2.0)));
  const auto n = static_cast<Index>(rings * ring + 2);
  Mesh tube{Positions(3, n), Triangles(3, 2 * n - 4)};
  const auto place = [&](double s, double across, double angle) {
    // The frame of the arc at s: the axis runs in the plane of x and y.
    const double bend = turn * s / length;
    const double radius = turn > 0.0 ? length / turn : 0.0;
    const Eigen::Vector3d center =
        turn > 0.0 ? Eigen::Vector3d(radius * std::sin(bend), radius * (1.0 - std::cos(bend)), 0.0)
                   : Eigen::Vector3d(s, 0.0, 0.0);
    const Eigen::Vector3d normal(-std::sin(bend), std::cos(bend), 0.0);
    return Eigen::Vector3d(
        center + across * (std::cos(angle) * normal + std::sin(angle) * Eigen::Vector3d::UnitZ()));
  };
  tube.points.leftCols(rings * ring) = gridOf(rings, ring, [&](int r, int k) {
    return place(length * r / (rings - 1), 1.0, spacing * (k + (r % 2) * 0.5));
  });
  // Caps: one point a little beyond each end.
  tube.points.col(n - 2) = place(-0.3, 0.0, 0.0);
  tube.points.col(n - 1) = place(length + 0.3, 0.0, 0.0);
  Eigen::Index t = 0;
  for (int r = 0; r + 1 < rings; ++r)
    for (int k = 0; k < ring; ++k) {
      const Index a = r * ring + k;
      const Index b = r * ring + (k + 1) % ring;
      const Index shift = r % 2;
      const Index c = (r + 1) * ring + (k + shift) % ring;
      const Index d = (r + 1) * ring + (k + shift + ring - 1) % ring;
      // Ring r + 1 is turned by half a spacing: a lies between d and c, or between c and the next.
      tube.triangles.col(t++) << a, b, c;
      tube.triangles.col(t++) << a, c, d;
    }
  for (int k = 0; k < ring; ++k) {
    tube.triangles.col(t++) << n - 2, (k + 1) % ring, k;
    tube.triangles.col(t++) << n - 1, (rings - 1) * ring + k, (rings - 1) * ring + (k + 1) % ring;
  }
  return tube;
}

/// Of the vertices from `first` on.
inline Triangles tetrahedron(Index first = 0) {
  return Triangles{{0, 0, 1, 2}, {2, 1, 2, 0}, {1, 3, 3, 3}}.array() + first;
}

/// A torus of rings x around quads, each split in two, over the vertices r * around + k: six
/// neighbours everywhere.
inline Triangles torusTriangles(Index rings, Index around) {
  Triangles triangles(3, 2 * rings * around);
  const auto at = [&](Index r, Index k) { return (r % rings) * around + k % around; };
  for (Index r = 0; r < rings; ++r)
    for (Index k = 0; k < around; ++k) {
      triangles.col(2 * at(r, k)) << at(r, k), at(r + 1, k), at(r + 1, k + 1);
      triangles.col(2 * at(r, k) + 1) << at(r, k), at(r + 1, k + 1), at(r, k + 1);
    }
  return triangles;
}

/// Distance of neighbours among n even points on the unit sphere: a hexagonal grid has sqrt(3) / 2
/// of its square of area for each point.
inline double sphereSpacing(Index n) {
  return std::sqrt(4.0 * kPi / (n * std::sqrt(3.0) / 2.0));
}

}  // namespace spherical_param::test
