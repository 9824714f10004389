#include "sphere_locator.h"

#include "exact_predicates.h"
#include "helpers.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace spherical_param::internal {
namespace {

/// The triangle of lowest index whose cone holds a direction, by asking all of them; -1: none.
Index byBruteForce(const Positions& sphere, const Triangles& triangles,
                   const Eigen::Vector3d& direction) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  for (Index t = 0; t < triangles.cols(); ++t) {
    bool is_inside = true;
    for (int k = 0; k < 3; ++k)
      is_inside = is_inside && orientation3d(zero, direction, sphere.col(triangles(k, t)),
                                             sphere.col(triangles((k + 1) % 3, t))) >= 0;
    if (is_inside)
      return t;
  }
  return -1;
}

/// Where the weights of a hit are, as a direction.
Eigen::Vector3d placeOf(const Positions& sphere, const Triangles& triangles, const SphereHit& hit) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    place += hit.weights[k] * sphere.col(triangles(k, hit.triangle));
  return place.normalized();
}

Positions tetrahedron() {
  Positions corners(3, 4);
  corners << 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, -1.0;
  return corners / std::sqrt(3.0);
}

TEST(SphereLocator, HitsAreThoseOfBruteForce) {
  for (const Index n : {4, 30, 120}) {
    // None flipped: all around the centre.
    const Positions sphere = n == 4 ? tetrahedron() : test::randomSphere(n, 5);
    const Triangles triangles = triangulateSphere(sphere, TriangulationOptions()).triangles;
    const SphereLocator locator(sphere, triangles, 1);
    Positions directions = test::randomSphere(100, 6);
    directions = test::horizontally(directions, sphere);  // corners
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      // Near the middles of sides, on either side of them.
      directions.conservativeResize(3, directions.cols() + 1);
      directions.rightCols<1>() = sphere.col(triangles(0, t)) + sphere.col(triangles(1, t));
    }
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
      const Eigen::Vector3d direction = directions.col(i);
      const Index expected = byBruteForce(sphere, triangles, direction);
      EXPECT_EQ(locator.locate(direction).triangle, expected);
      for (const double length : {1.0, 1e-200, 3e150}) {
        const SphereHit hit = locator.locate(length * direction);
        ASSERT_GE(hit.triangle, 0);
        EXPECT_GE(hit.weights.minCoeff(), 0.0);
        EXPECT_NEAR(hit.weights.sum(), 1.0, 1e-15);
        EXPECT_LE((placeOf(sphere, triangles, hit) - direction.normalized()).norm(), 1e-9);
      }
    }
  }
}

TEST(SphereLocator, ACornerHasAllTheWeight) {
  const Positions sphere = test::randomSphere(100, 8);
  const Triangles triangles = triangulateSphere(sphere, TriangulationOptions()).triangles;
  const SphereLocator locator(sphere, triangles, 1);
  for (Index v = 0; v < sphere.cols(); ++v) {
    const SphereHit hit = locator.locate(sphere.col(v));
    ASSERT_GE(hit.triangle, 0);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(hit.weights[k], triangles(k, hit.triangle) == v ? 1.0 : 0.0);
  }
}

TEST(SphereLocator, OutsideOfTheTrianglesIsNowhere) {
  Positions sphere(3, 3);
  sphere.setIdentity();
  Triangles triangles(3, 1);
  triangles << 0, 1, 2;
  const SphereLocator locator(sphere, triangles, 1);
  EXPECT_EQ(locator.locate({-1.0, -1.0, -1.0}).triangle, -1);
  EXPECT_EQ(locator.locate({1.0, 1.0, -1e-90}).triangle, -1);
  const SphereHit middle = locator.locate({2.0, 2.0, 2.0});
  EXPECT_EQ(middle.triangle, 0);
  EXPECT_LE((middle.weights - Eigen::Vector3d::Constant(1.0 / 3.0)).norm(), 1e-15);
  const SphereHit side = locator.locate({1.0, 1.0, 0.0});
  EXPECT_EQ(side.triangle, 0);
  EXPECT_EQ(side.weights[2], 0.0);
}

TEST(SphereLocator, SameForAnyNumberOfThreads) {
  const Positions sphere = test::spiralSphere(3000);
  const Triangles triangles = triangulateSphere(sphere, TriangulationOptions()).triangles;
  const SphereLocator alone(sphere, triangles, 1);
  const SphereLocator together(sphere, triangles, 4);
  const Positions directions = test::randomSphere(300, 9);
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const SphereHit a = alone.locate(directions.col(i));
    const SphereHit b = together.locate(directions.col(i));
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.weights, b.weights);
  }
}

}  // namespace
}  // namespace spherical_param::internal
