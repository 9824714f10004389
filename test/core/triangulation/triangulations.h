#pragma once

#include "helpers.h"
#include "sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

/// Sets of directions and checks for the tests of the triangulation.
namespace spherical_param::test {

/// A closed sphere over all points, and a report whose sums are right.
inline void expectSound(const Positions& directions, const SphereTriangulation& result) {
  const auto n = static_cast<Index>(directions.cols());
  EXPECT_EQ(result.triangles.cols(), 2 * n - 4);
  EXPECT_TRUE(isSphereOverAll(result.triangles, n));
  EXPECT_EQ(result.report.hull_vertices + result.report.reinserted, n);
}

/// Random points in a cap of the given radius around a pole.
inline Positions cap(Index n, double radius, const Eigen::Vector3d& pole, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-radius, radius);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i)
    points.col(i) =
        (pole + Eigen::Vector3d(uniform(random), uniform(random), uniform(random))).normalized();
  return points;
}

/// n points on the circle of latitude of height z; the angle of point i is that of i turns of n.
inline Positions latitude(Index n, double z) {
  Positions points(3, n);
  const double radius = std::sqrt(1.0 - z * z);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2.0 * kPi * i / n;
    points.col(i) << radius * std::cos(angle), radius * std::sin(angle), z;
  }
  return points;
}

/// Sides among the points from `first` on, which lie in a tiny cap around a pole, whose opposite
/// angles exceed a half turn, beyond a tolerance: the planar criterion, which in a cap of radius r
/// is that on the sphere up to r. Counts the sides it looks at.
inline int sidesToFlip(const Positions& points, const Triangles& triangles,
                       const Eigen::Vector3d& pole, Index first, int& checked) {
  std::map<std::pair<Index, Index>, Index> third;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      third[{triangles(k, t), triangles((k + 1) % 3, t)}] = triangles((k + 2) % 3, t);
  const Eigen::Vector3d east = pole.unitOrthogonal();
  const Eigen::Vector3d north = pole.cross(east);
  const auto angle = [&](Index at, Index a, Index b) {
    const auto flat = [&](Index i) {
      const Eigen::Vector3d d = (points.col(i) - points.col(at)) * 1e8;
      return Eigen::Vector2d(d.dot(east), d.dot(north));
    };
    return std::acos(std::clamp(flat(a).normalized().dot(flat(b).normalized()), -1.0, 1.0));
  };
  int bad = 0;
  for (const auto& [edge, apex] : third) {
    const Index opposite = third.at({edge.second, edge.first});
    if (std::min({edge.first, edge.second, apex, opposite}) < first)
      continue;
    ++checked;
    const double sum =
        angle(apex, edge.first, edge.second) + angle(opposite, edge.first, edge.second);
    bad += sum > kPi + 1e-3 ? 1 : 0;
  }
  return bad;
}

}  // namespace spherical_param::test
