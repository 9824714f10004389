#include "sphere_triangulation.h"

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
using Method = TriangulationMethod;

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

/// What holds whatever the method.
class EveryMethod : public ::testing::TestWithParam<Method> {
protected:
  SphereTriangulation triangulate(const Positions& directions) const {
    return triangulateSphere(directions, GetParam());
  }
  bool isQhull() const { return GetParam() == Method::Qhull; }
};
INSTANTIATE_TEST_SUITE_P(SphereTriangulation, EveryMethod,
                         ::testing::Values(Method::Qhull, Method::Incremental),
                         [](const auto& instance) {
                           return instance.param == Method::Qhull ? "Qhull" : "Incremental";
                         });

TEST_P(EveryMethod, IsTheConvexHullOfRandomPoints) {
  for (const Index n : {4, 5, 40})
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Positions points = randomSphere(n, seed);
      const SphereTriangulation result = triangulate(points);
      expectSound(points, result);
      if (n == 40) {
        EXPECT_EQ(test::canonical(result.triangles), bruteForceHull(points));
        EXPECT_EQ(result.report.reinserted, 0);
        EXPECT_FALSE(result.report.hull_rejected);
      }
    }
}

TEST_P(EveryMethod, EveryPointIsAVertexWhereManyLieInOnePlane) {
  for (const int m : {2, 3, 6, 11}) {
    Positions points = test::cubeGrid(m);
    points.array() -= 0.5;
    points.colwise().normalize();
    const SphereTriangulation result = triangulate(points);
    expectSound(points, result);
    EXPECT_NEAR(test::volumeOf(points, result.triangles), 4.0 / 3.0 * test::kPi,
                m == 2 ? 3.0 : 1.5);
  }
  const Positions circle = latitude(300, 0.0);
  expectSound(circle, triangulate(circle));
  // A prism of two regular n-gons: nothing else is convex.
  const Index n = 500;
  const Positions prism = horizontally(latitude(n, 0.6), latitude(n, -0.6));
  const SphereTriangulation result = triangulate(prism);
  expectSound(prism, result);
  EXPECT_NEAR(test::volumeOf(prism, result.triangles),
              1.2 * 0.5 * n * 0.64 * std::sin(2.0 * test::kPi / n), 1e-9);
}

TEST_P(EveryMethod, EveryPointOfTinyCapsIsAVertex) {
  for (const double radius : {0.05, 1e-3, 1e-7, 1e-9, 1e-12, 1e-15}) {
    const Positions one = cap(1500, radius, kPole, 2);
    for (const Positions& points :
         {one, horizontally(one, cap(1500, radius, -kPole, 3)),
          horizontally(cap(500, 0.05, kPole, 4), one), horizontally(randomSphere(500, 1), one)})
      expectSound(points, triangulate(points));
  }
}

TEST_P(EveryMethod, RepeatedPositionsAreAllVertices) {
  const Positions some = randomSphere(100, 3);
  const Positions points =
      horizontally(horizontally(some, some), Positions(some.col(0).replicate(1, 200)));
  SphereTriangulation result = triangulate(points);
  expectSound(points, result);
  EXPECT_EQ(result.report.coincident, 300);
  EXPECT_EQ(result.report.hull_vertices, 100);

  const Positions one = Eigen::Vector3d::UnitX().replicate(1, 50);
  expectSound(one, triangulate(one));
  const Positions two = horizontally(one, Eigen::Vector3d::UnitY().replicate(1, 50));
  result = triangulate(two);
  expectSound(two, result);
  EXPECT_EQ(result.report.coincident, 98);
  EXPECT_EQ(result.report.hull_rejected, isQhull());
}

TEST(SphereTriangulation, PointsThatQhullDropsHaveTheTrianglesOfTheExactOne) {
  const Positions points = horizontally(randomSphere(200, 1), cap(400, 1e-8, kPole, 2));
  const SphereTriangulation result = triangulateSphere(points, Method::Qhull);
  expectSound(points, result);
  ASSERT_GT(result.report.reinserted, 100) << "this cap does not put qhull to the test";
  const auto found = test::canonical(result.triangles);
  const auto exact = test::canonical(triangulateSphere(points, Method::Incremental).triangles);
  std::vector<std::array<Index, 3>> wrong;
  std::set_difference(found.begin(), found.end(), exact.begin(), exact.end(),
                      std::back_inserter(wrong));
  // qhull's own facets among the kept points are only as good as its round-off.
  EXPECT_LE(wrong.size(), exact.size() / 50);
}

}  // namespace
}  // namespace spherical_param
