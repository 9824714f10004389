#include "spherical_param/sphere_triangulation.h"

#include "triangulations.h"

#include <array>
#include <iterator>
#include <vector>

namespace spherical_param {
namespace {

using test::cap;
using test::expectSound;
using test::horizontally;
using test::latitude;
using test::randomSphere;

const Eigen::Vector3d kPole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();

/// Convex hull by brute force: a triangle is a facet if all points are on one side of its plane.
std::vector<std::array<Index, 3>> bruteForceHull(const Positions& points) {
  Triangles facets(3, 0);
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = i + 1; j < points.cols(); ++j)
      for (Index k = i + 1; k < points.cols(); ++k) {
        if (j == k)
          continue;
        const Eigen::Vector3d normal =
            (points.col(j) - points.col(i)).cross(points.col(k) - points.col(i));
        if (((points.colwise() - points.col(i)).transpose() * normal).maxCoeff() < 1e-12) {
          facets.conservativeResize(3, facets.cols() + 1);
          facets.col(facets.cols() - 1) << i, j, k;
        }
      }
  return test::canonical(facets);
}

TEST(SphereTriangulation, IsTheConvexHullOfRandomPoints) {
  for (const Index n : {4, 5, 40})
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Positions points = randomSphere(n, seed);
      const Triangles result = triangulateSphere(points);
      expectSound(points, result);
      if (n == 40) {
        EXPECT_EQ(test::canonical(result), bruteForceHull(points));
      }
    }
}

TEST(SphereTriangulation, EveryPointIsAVertexWhereManyLieInOnePlane) {
  for (const int m : {2, 3, 6, 11}) {
    Positions points = test::cubeGrid(m);
    points.array() -= 0.5;
    points.colwise().normalize();
    const Triangles result = triangulateSphere(points);
    expectSound(points, result);
    EXPECT_NEAR(test::volumeOf(points, result), 4.0 / 3.0 * test::kPi, m == 2 ? 3.0 : 1.5);
  }
  const Positions circle = latitude(300, 0.0);
  expectSound(circle, triangulateSphere(circle));
  // A prism of two regular n-gons: nothing else is convex.
  const Index n = 500;
  const Positions prism = horizontally(latitude(n, 0.6), latitude(n, -0.6));
  const Triangles result = triangulateSphere(prism);
  expectSound(prism, result);
  EXPECT_NEAR(test::volumeOf(prism, result), 1.2 * 0.5 * n * 0.64 * std::sin(2.0 * test::kPi / n),
              1e-9);
}

TEST(SphereTriangulation, EveryPointOfTinyCapsIsAVertex) {
  for (const double radius : {0.05, 1e-3, 1e-7, 1e-9, 1e-12, 1e-15}) {
    const Positions one = cap(1500, radius, kPole, 2);
    for (const Positions& points :
         {one, horizontally(one, cap(1500, radius, -kPole, 3)),
          horizontally(cap(500, 0.05, kPole, 4), one), horizontally(randomSphere(500, 1), one)})
      expectSound(points, triangulateSphere(points));
  }
}

TEST(SphereTriangulation, RepeatedPositionsAreAllVertices) {
  const Positions some = randomSphere(100, 3);
  const Positions points =
      horizontally(horizontally(some, some), Positions(some.col(0).replicate(1, 200)));
  Triangles result = triangulateSphere(points);
  expectSound(points, result);

  const Positions one = Eigen::Vector3d::UnitX().replicate(1, 50);
  expectSound(one, triangulateSphere(one));
  const Positions two = horizontally(one, Eigen::Vector3d::UnitY().replicate(1, 50));
  result = triangulateSphere(two);
  expectSound(two, result);
}

}  // namespace
}  // namespace spherical_param
