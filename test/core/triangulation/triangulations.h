#pragma once

#include "helpers.h"
#include "incremental_delaunay.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

/// Sets of directions and checks for the tests of the triangulation.
namespace spherical_param::test {

/// A closed sphere over all points.
inline void expectSound(const Positions& directions, const Triangles& triangles) {
  const auto n = static_cast<Index>(directions.cols());
  EXPECT_EQ(triangles.cols(), 2 * n - 4);
  EXPECT_TRUE(isSphereOverAll(triangles, n));
}
inline void expectSound(const Positions& directions, const SphereDelaunay& result) {
  expectSound(directions, result.triangles);
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

}  // namespace spherical_param::test
