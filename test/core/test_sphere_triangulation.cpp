#include "spherical_param/sphere_triangulation.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using test::horizontally;
using test::isSphereOverAll;
using test::randomSphere;

/// A closed sphere over all points, outward on the sphere.
void expectSound(const Positions& directions, const SphereTriangulation& result) {
  const auto n = static_cast<Index>(directions.cols());
  EXPECT_EQ(result.triangles.cols(), 2 * n - 4);
  EXPECT_TRUE(isSphereOverAll(result.triangles, n));
  EXPECT_EQ(result.hull_vertices + result.reinserted, n);
}

/// Convex hull by brute force: a triangle is a facet if all points are on one side of its plane.
std::vector<std::array<Index, 3>> bruteForceHull(const Positions& points) {
  Triangles facets(3, 0);
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = 0; j < points.cols(); ++j)
      for (Index k = 0; k < points.cols(); ++k) {
        if (i >= j || i >= k || j == k)
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

/// Points in a cap of the given radius around the north pole, which lies at `pole`.
Positions cap(Index n, double radius, const Eigen::Vector3d& pole, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-radius, radius);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i)
    points.col(i) =
        (pole + Eigen::Vector3d(uniform(random), uniform(random), uniform(random))).normalized();
  return points;
}

TEST(SphereTriangulation, IsTheConvexHullOfRandomPoints) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Positions points = randomSphere(40, seed);
    const SphereTriangulation result = triangulateSphere(points);
    expectSound(points, result);
    EXPECT_EQ(test::canonical(result.triangles), bruteForceHull(points));
    EXPECT_EQ(result.reinserted, 0);
    EXPECT_FALSE(result.hull_rejected);
  }
}

TEST(SphereTriangulation, FourPointsAreATetrahedron) {
  const Positions points = randomSphere(4, 9);
  expectSound(points, triangulateSphere(points));
}

TEST(SphereTriangulation, CubeGridIsTriangulatedWhole) {
  for (const int m : {2, 3, 6, 11}) {
    Positions points = test::cubeGrid(m);
    points.array() -= 0.5;
    points.colwise().normalize();
    const SphereTriangulation result = triangulateSphere(points);
    expectSound(points, result);
    EXPECT_NEAR(test::volumeOf(points, result.triangles), 4.0 / 3.0 * test::kPi,
                m == 2 ? 3.0 : 1.5);
  }
}

TEST(SphereTriangulation, TwoCirclesAreTriangulatedWhole) {
  const Index n = 500;
  Positions points(3, 2 * n);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2.0 * test::kPi * i / n;
    points.col(i) << 0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.6;
    points.col(n + i) << 0.8 * std::cos(angle), 0.8 * std::sin(angle), -0.6;
  }
  const SphereTriangulation result = triangulateSphere(points);
  expectSound(points, result);
  // A prism of two regular n-gons: nothing else is convex.
  const double gon = 0.5 * n * 0.64 * std::sin(2.0 * test::kPi / n);
  EXPECT_NEAR(test::volumeOf(points, result.triangles), 1.2 * gon, 1e-9);
}

TEST(SphereTriangulation, OneGreatCircleIsTriangulatedWhole) {
  const Index n = 300;
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2.0 * test::kPi * i / n;
    points.col(i) << std::cos(angle), std::sin(angle), 0.0;
  }
  expectSound(points, triangulateSphere(points));
}

TEST(SphereTriangulation, PointsOfATinyCapAreAllVertices) {
  for (const double radius : {1e-7, 1e-9, 1e-12, 1e-15}) {
    const Positions points = horizontally(
        randomSphere(500, 1), cap(3000, radius, Eigen::Vector3d(0.3, -0.5, 0.7).normalized(), 2));
    const SphereTriangulation result = triangulateSphere(points);
    expectSound(points, result);
    EXPECT_GT(result.reinserted, 0) << "this cap does not put qhull to the test";
  }
}

TEST(SphereTriangulation, NothingButTinyCapsIsTriangulatedWhole) {
  const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  for (const double radius : {1e-3, 1e-9, 1e-14}) {
    const Positions one = cap(3000, radius, pole, 2);
    expectSound(one, triangulateSphere(one));
    const Positions two = horizontally(one, cap(3000, radius, -pole, 3));
    expectSound(two, triangulateSphere(two));
  }
}

// Points that qhull drops still get the triangles that are locally right: around each such point
// of the cap, no side is shorter flipped.
TEST(SphereTriangulation, ReinsertedPointsAreLocallyDelaunay) {
  const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  const Positions points = horizontally(randomSphere(200, 1), cap(400, 1e-8, pole, 2));
  const SphereTriangulation result = triangulateSphere(points);
  expectSound(points, result);
  ASSERT_GT(result.reinserted, 100);
  // In the cap the sphere is its tangent plane up to 1e-16: compare with the planar criterion.
  std::map<std::pair<Index, Index>, Index> third;
  for (Eigen::Index t = 0; t < result.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      third[{result.triangles(k, t), result.triangles((k + 1) % 3, t)}] =
          result.triangles((k + 2) % 3, t);
  const Eigen::Vector3d east = pole.unitOrthogonal();
  const Eigen::Vector3d north = pole.cross(east);
  const auto angle = [&](Index at, Index a, Index b) {
    const auto flat = [&](Index i) {
      const Eigen::Vector3d d = (points.col(i) - points.col(at)) * 1e8;
      return Eigen::Vector2d(d.dot(east), d.dot(north));
    };
    return std::acos(std::clamp(flat(a).normalized().dot(flat(b).normalized()), -1.0, 1.0));
  };
  int checked = 0;
  int bad = 0;
  for (const auto& [edge, apex] : third) {
    const Index opposite = third.at({edge.second, edge.first});
    if (std::min({edge.first, edge.second, apex, opposite}) < 200)
      continue;
    ++checked;
    bad += angle(apex, edge.first, edge.second) + angle(opposite, edge.first, edge.second) >
                   test::kPi + 1e-3
               ? 1
               : 0;
  }
  EXPECT_GT(checked, 1000);
  // qhull's own facets among the kept points are only as good as its round-off.
  EXPECT_LE(bad, checked / 50);
}

TEST(SphereTriangulation, RepeatedPositionsAreAllVertices) {
  Positions points = randomSphere(100, 3);
  points = horizontally(points, points);
  points = horizontally(points, Positions(points.col(0).replicate(1, 200)));
  const SphereTriangulation result = triangulateSphere(points);
  expectSound(points, result);
  EXPECT_EQ(result.coincident, 300);
  EXPECT_EQ(result.hull_vertices, 100);
}

TEST(SphereTriangulation, AllPointsAtOneOrTwoPlacesAreAllVertices) {
  const Positions one = Eigen::Vector3d::UnitX().replicate(1, 50);
  expectSound(one, triangulateSphere(one));
  const Positions two = horizontally(one, Eigen::Vector3d::UnitY().replicate(1, 50));
  const SphereTriangulation result = triangulateSphere(two);
  expectSound(two, result);
  EXPECT_EQ(result.coincident, 98);
  EXPECT_TRUE(result.hull_rejected);
}

TEST(SphereTriangulation, PointsOfOneHemisphereAreAllVertices) {
  Positions points = cap(1000, 0.05, Eigen::Vector3d::UnitZ(), 4);
  expectSound(points, triangulateSphere(points));
  points = horizontally(points, cap(1000, 1e-9, Eigen::Vector3d(0.02, 0.01, 1.0).normalized(), 5));
  expectSound(points, triangulateSphere(points));
}

TEST(SphereTriangulation, BadInputIsInvalidInput) {
  EXPECT_THROW(triangulateSphere(randomSphere(3, 1)), InvalidInput);
  Positions points = randomSphere(10, 1);
  points.col(4) *= 1.1;
  EXPECT_THROW(triangulateSphere(points), InvalidInput);
  points(0, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(triangulateSphere(points), InvalidInput);
}

TEST(SphereTriangulation, ConcurrentCallsAgreeWithSingleOnes) {
  constexpr std::size_t count = 4;
  std::vector<Triangles> alone(count);
  const auto run = [](std::size_t i) {
    return triangulateSphere(randomSphere(500 + 100 * static_cast<Index>(i), i)).triangles;
  };
  for (std::size_t i = 0; i < count; ++i)
    alone[i] = run(i);
  const std::vector<Triangles> together = test::runTogether(count, run);
  for (std::size_t i = 0; i < count; ++i)
    EXPECT_EQ(alone[i], together[i]);
}

}  // namespace
}  // namespace spherical_param
