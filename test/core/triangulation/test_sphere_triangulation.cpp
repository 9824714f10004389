#include "spherical_param/sphere_triangulation.h"

#include "exact_predicates.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <functional>
#include <set>

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
  EXPECT_EQ(result.report.hull_vertices + result.report.reinserted, n);
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

/// Sides among the points from `first` on, which lie in a tiny cap around a pole, whose opposite
/// angles exceed a half turn, beyond a tolerance: the planar criterion, which in a cap of radius r
/// is that on the sphere up to r. Counts the sides it looks at.
int sidesToFlip(const Positions& points, const Triangles& triangles, const Eigen::Vector3d& pole,
                Index first, int& checked) {
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
    bad += angle(apex, edge.first, edge.second) + angle(opposite, edge.first, edge.second) >
                   test::kPi + 1e-3
               ? 1
               : 0;
  }
  return bad;
}

using Method = TriangulationMethod;

/// What holds whatever the method.
class EveryMethod : public ::testing::TestWithParam<Method> {
protected:
  SphereTriangulation triangulate(const Positions& directions) const {
    return triangulateSphere(directions, {GetParam()});
  }
};
INSTANTIATE_TEST_SUITE_P(SphereTriangulation, EveryMethod,
                         ::testing::Values(Method::Qhull, Method::Incremental),
                         [](const auto& instance) {
                           return instance.param == Method::Qhull ? "Qhull" : "Incremental";
                         });

TEST_P(EveryMethod, IsTheConvexHullOfRandomPoints) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Positions points = randomSphere(40, seed);
    const SphereTriangulation result = triangulate(points);
    expectSound(points, result);
    EXPECT_EQ(test::canonical(result.triangles), bruteForceHull(points));
    EXPECT_EQ(result.report.reinserted, 0);
    EXPECT_FALSE(result.report.hull_rejected);
  }
}

TEST_P(EveryMethod, FourPointsAreATetrahedron) {
  const Positions points = randomSphere(4, 9);
  expectSound(points, triangulate(points));
}

TEST_P(EveryMethod, CubeGridIsTriangulatedWhole) {
  for (const int m : {2, 3, 6, 11}) {
    Positions points = test::cubeGrid(m);
    points.array() -= 0.5;
    points.colwise().normalize();
    const SphereTriangulation result = triangulate(points);
    expectSound(points, result);
    EXPECT_NEAR(test::volumeOf(points, result.triangles), 4.0 / 3.0 * test::kPi,
                m == 2 ? 3.0 : 1.5);
  }
}

TEST_P(EveryMethod, TwoCirclesAreTriangulatedWhole) {
  const Index n = 500;
  Positions points(3, 2 * n);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2.0 * test::kPi * i / n;
    points.col(i) << 0.8 * std::cos(angle), 0.8 * std::sin(angle), 0.6;
    points.col(n + i) << 0.8 * std::cos(angle), 0.8 * std::sin(angle), -0.6;
  }
  const SphereTriangulation result = triangulate(points);
  expectSound(points, result);
  // A prism of two regular n-gons: nothing else is convex.
  const double gon = 0.5 * n * 0.64 * std::sin(2.0 * test::kPi / n);
  EXPECT_NEAR(test::volumeOf(points, result.triangles), 1.2 * gon, 1e-9);
}

TEST_P(EveryMethod, OneGreatCircleIsTriangulatedWhole) {
  const Index n = 300;
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const double angle = 2.0 * test::kPi * i / n;
    points.col(i) << std::cos(angle), std::sin(angle), 0.0;
  }
  expectSound(points, triangulate(points));
}

TEST_P(EveryMethod, PointsOfATinyCapAreAllVertices) {
  for (const double radius : {1e-7, 1e-9, 1e-12, 1e-15}) {
    const Positions points = horizontally(
        randomSphere(500, 1), cap(3000, radius, Eigen::Vector3d(0.3, -0.5, 0.7).normalized(), 2));
    const SphereTriangulation result = triangulate(points);
    expectSound(points, result);
    if (GetParam() == Method::Qhull) {
      EXPECT_GT(result.report.reinserted, 0) << "this cap does not put qhull to the test";
    }
  }
}

TEST_P(EveryMethod, NothingButTinyCapsIsTriangulatedWhole) {
  const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  for (const double radius : {1e-3, 1e-9, 1e-14}) {
    const Positions one = cap(3000, radius, pole, 2);
    expectSound(one, triangulate(one));
    const Positions two = horizontally(one, cap(3000, radius, -pole, 3));
    expectSound(two, triangulate(two));
  }
}

// Points that qhull drops still get the triangles that are locally right: around each such point
// of the cap, no side is shorter flipped.
TEST_P(EveryMethod, CrowdedPointsAreLocallyDelaunay) {
  const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  const Positions points = horizontally(randomSphere(200, 1), cap(400, 1e-8, pole, 2));
  const SphereTriangulation result = triangulate(points);
  expectSound(points, result);
  if (GetParam() == Method::Qhull) {
    ASSERT_GT(result.report.reinserted, 100);
  }
  int checked = 0;
  const int bad = sidesToFlip(points, result.triangles, pole, 200, checked);
  EXPECT_GT(checked, 1000);
  // qhull's own facets among the kept points are only as good as its round-off.
  EXPECT_LE(bad, GetParam() == Method::Qhull ? checked / 50 : 0);
}

TEST_P(EveryMethod, RepeatedPositionsAreAllVertices) {
  Positions points = randomSphere(100, 3);
  points = horizontally(points, points);
  points = horizontally(points, Positions(points.col(0).replicate(1, 200)));
  const SphereTriangulation result = triangulate(points);
  expectSound(points, result);
  EXPECT_EQ(result.report.coincident, 300);
  EXPECT_EQ(result.report.hull_vertices, 100);
}

TEST_P(EveryMethod, AllPointsAtOneOrTwoPlacesAreAllVertices) {
  const Positions one = Eigen::Vector3d::UnitX().replicate(1, 50);
  expectSound(one, triangulate(one));
  const Positions two = horizontally(one, Eigen::Vector3d::UnitY().replicate(1, 50));
  const SphereTriangulation result = triangulate(two);
  expectSound(two, result);
  EXPECT_EQ(result.report.coincident, 98);
  EXPECT_EQ(result.report.hull_rejected, GetParam() == Method::Qhull);
}

TEST_P(EveryMethod, PointsOfOneHemisphereAreAllVertices) {
  Positions points = cap(1000, 0.05, Eigen::Vector3d::UnitZ(), 4);
  expectSound(points, triangulate(points));
  points = horizontally(points, cap(1000, 1e-9, Eigen::Vector3d(0.02, 0.01, 1.0).normalized(), 5));
  expectSound(points, triangulate(points));
}

TEST_P(EveryMethod, BadInputIsInvalidInput) {
  EXPECT_THROW(triangulate(randomSphere(3, 1)), InvalidInput);
  Positions points = randomSphere(10, 1);
  points.col(4) *= 1.1;
  EXPECT_THROW(triangulate(points), InvalidInput);
  points(0, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(triangulate(points), InvalidInput);
}

/// Most triangles around one of the vertices [0, n).
int highestDegree(const Triangles& triangles, Index n) {
  std::vector<int> degree(static_cast<std::size_t>(n), 0);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      ++degree[static_cast<std::size_t>(triangles(k, t))];
  return *std::max_element(degree.begin(), degree.end());
}

/// Points crowded into caps of radius 0.3 and 0.01.
Positions clusters(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Positions centres = randomSphere(5, seed + 100);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const double radius = i % 2 == 0 ? 0.3 : 0.01;
    points.col(i) = (centres.col(i % 5) +
                     radius * Eigen::Vector3d(normal(random), normal(random), normal(random)))
                        .normalized();
  }
  return points;
}

/// What an embedding makes of a few limbs: distances to their tips that shrink exponentially.
Positions limbs(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Positions tips = randomSphere(4, seed + 200);
  Positions points(3, n);
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector3d tip = tips.col(i % 4);
    const Eigen::Vector3d east = tip.unitOrthogonal();
    const double radius = std::exp(-7.0 * uniform(random));
    const double angle = 2.0 * test::kPi * uniform(random);
    points.col(i) =
        (tip + radius * (std::cos(angle) * east + std::sin(angle) * tip.cross(east))).normalized();
  }
  return points;
}

TEST(IncrementalTriangulation, IsTheDefault) {
  const Positions points = randomSphere(300, 4);
  EXPECT_EQ(triangulateSphere(points).triangles,
            triangulateSphere(points, {Method::Incremental}).triangles);
}

TEST(IncrementalTriangulation, HasTheTrianglesOfQhull) {
  int compared = 0;
  for (const Index n : {4, 5, 6, 7, 10, 30, 100, 127, 128, 129, 999, 1000, 3000, 20000})
    for (std::uint64_t seed = 0; seed < (n < 1000 ? 20U : 3U); ++seed)
      for (const Positions& points : {randomSphere(n, seed), clusters(n, seed), limbs(n, seed),
                                      cap(n, 0.1, {1, 0, 0}, seed)}) {
        const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
        expectSound(points, result);
        EXPECT_EQ(result.report.coincident, 0);
        const SphereTriangulation reference = triangulateSphere(points, {Method::Qhull});
        if (reference.report.reinserted > 0)
          continue;
        ++compared;
        ASSERT_EQ(test::canonical(result.triangles), test::canonical(reference.triangles))
            << "n = " << n << ", seed " << seed;
      }
  EXPECT_GT(compared, 900);
}

// No point is inside the circle of any triangle, that is, outside its plane.
TEST(IncrementalTriangulation, CirclesOfTrianglesAreEmpty) {
  for (const Positions& points : {randomSphere(600, 1), clusters(600, 2), limbs(600, 3)}) {
    const Triangles triangles = triangulateSphere(points, {Method::Incremental}).triangles;
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      for (Index p = 0; p < points.cols(); ++p)
        if ((triangles.col(t).array() != p).all()) {
          // Negative on the side that the normal of the counter-clockwise triangle points away
          // from.
          ASSERT_LT(internal::orientation3d(points.col(triangles(0, t)),
                                            points.col(triangles(1, t)),
                                            points.col(triangles(2, t)), points.col(p)),
                    0);
        }
  }
}

TEST(IncrementalTriangulation, DoesNotDependOnTheOrderOfThePoints) {
  for (const Positions& points :
       {randomSphere(5000, 1), clusters(5000, 2), limbs(5000, 3),
        horizontally(randomSphere(500, 1), cap(3000, 1e-11, {0.6, 0.0, 0.8}, 2))}) {
    const auto n = static_cast<Index>(points.cols());
    std::vector<Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Index{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    Positions shuffled(3, n);
    for (Index i = 0; i < n; ++i)
      shuffled.col(i) = points.col(order[static_cast<std::size_t>(i)]);
    Triangles triangles = triangulateSphere(shuffled, {Method::Incremental}).triangles;
    triangles =
        triangles.unaryExpr([&](Index v) { return order[static_cast<std::size_t>(v)]; }).eval();
    EXPECT_EQ(test::canonical(triangles),
              test::canonical(triangulateSphere(points, {Method::Incremental}).triangles));
  }
}

/// Integer points in the plane, and their image around the lowest or highest point of the sphere:
/// an integer step is 2^-53, small enough for the sphere to be its tangent plane.
struct IntegerCluster {
  std::vector<std::array<std::int64_t, 2>> places;

  Positions directions(double z) const {
    Positions result(3, static_cast<Eigen::Index>(places.size()));
    for (std::size_t i = 0; i < places.size(); ++i)
      result.col(static_cast<Eigen::Index>(i)) << std::ldexp(places[i][0], -53),
          std::ldexp(places[i][1], -53), z;
    return result;
  }
  /// Twice the area, counter-clockwise.
  std::int64_t area(std::size_t a, std::size_t b, std::size_t c) const {
    return (places[b][0] - places[a][0]) * (places[c][1] - places[a][1]) -
           (places[b][1] - places[a][1]) * (places[c][0] - places[a][0]);
  }
  /// Positive if d is inside the circle of a, b, c (counter-clockwise). Exact below 2^14.
  std::int64_t inCircle(std::size_t a, std::size_t b, std::size_t c, std::size_t d) const {
    std::int64_t sum = 0;
    const std::array<std::size_t, 3> corners{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t x = places[corners[k]][0] - places[d][0];
      const std::int64_t y = places[corners[k]][1] - places[d][1];
      sum += (x * x + y * y) * area(d, corners[(k + 1) % 3], corners[(k + 2) % 3]);
    }
    return sum;
  }
  /// Delaunay triangles by brute force, but for those of circles of more than 2^6 steps of the
  /// grid below: the points around the cluster have a say in these.
  std::vector<std::array<Index, 3>> smallTriangles() const {
    std::vector<std::array<Index, 3>> result;
    for (std::size_t a = 0; a < places.size(); ++a)
      for (std::size_t b = a + 1; b < places.size(); ++b)
        for (std::size_t c = a + 1; c < places.size(); ++c)
          if (b != c && area(a, b, c) > 0 && isSmall(a, b, c)) {
            bool is_empty = true;
            for (std::size_t d = 0; d < places.size() && is_empty; ++d)
              is_empty = d == a || d == b || d == c || inCircle(a, b, c, d) <= 0;
            if (is_empty)
              result.push_back(
                  {static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c)});
          }
    std::sort(result.begin(), result.end());
    return result;
  }
  bool isSmall(std::size_t a, std::size_t b, std::size_t c) const {
    const auto length = [&](std::size_t i, std::size_t j) {
      return std::hypot(static_cast<double>(places[i][0] - places[j][0]),
                        static_cast<double>(places[i][1] - places[j][1]));
    };
    const double radius =
        length(a, b) * length(b, c) * length(c, a) / (2.0 * static_cast<double>(area(a, b, c)));
    return radius < 1024.0 * 64.0;
  }
  /// The small ones of some triangles of which the cluster's points are the first.
  std::vector<std::array<Index, 3>> smallOf(const Triangles& triangles) const {
    std::vector<std::array<Index, 3>> result;
    const auto n = static_cast<Index>(places.size());
    for (const auto& t : test::canonical(triangles))
      if (std::max({t[0], t[1], t[2]}) < n &&
          isSmall(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                  static_cast<std::size_t>(t[2])))
        result.push_back(t);
    return result;
  }
};

/// A grid of (2 m + 1)^2 points of spacing 2^-43, each moved at random by up to `jitter` x 2^-53.
IntegerCluster integerGrid(int m, int jitter, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> move(-jitter, jitter);
  IntegerCluster cluster;
  for (int i = -m; i <= m; ++i)
    for (int j = -m; j <= m; ++j)
      cluster.places.push_back({1024 * i + move(random), 1024 * j + move(random)});
  return cluster;
}

// Spacings of 1e-13: the triangles are those of integer arithmetic. Around the lowest point the
// pole is opposite and its direction exact, around the highest point the pole is in the cluster.
TEST(IncrementalTriangulation, IsThatOfIntegerArithmeticInClustersOf1em13) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const double z : {-1.0, 1.0}) {
      IntegerCluster cluster = integerGrid(3, 400, seed);
      Positions points = horizontally(cluster.directions(z), randomSphere(200, seed));
      points = horizontally(points, Eigen::Vector3d::UnitZ());
      SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
      expectSound(points, result);
      EXPECT_EQ(result.report.coincident, 0);
      if (z > 0.0) {
        // Seen from outside, the highest point has the axes the right way round; there the added
        // point is in the midst of the cluster.
        cluster.places.push_back({0, 0});
        const auto added = static_cast<Index>(cluster.places.size()) - 1;
        result.triangles = result.triangles
                               .unaryExpr([&](Index v) {
                                 return v == points.cols() - 1 ? added : v < added ? v : v + 1;
                               })
                               .eval();
      } else {
        flipOrientation(result.triangles);
      }
      const auto expected = cluster.smallTriangles();
      EXPECT_GT(expected.size(), 60U);
      EXPECT_EQ(cluster.smallOf(result.triangles), expected);
    }
}

// The same elsewhere on the sphere: rounding of a unit vector is 1e-3 of the spacing.
TEST(IncrementalTriangulation, IsRightWithinRoundingInClustersOf1em13) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const int axis : {0, 1}) {
      const IntegerCluster cluster = integerGrid(20, 400, seed);
      Positions directions = cluster.directions(seed % 2 == 0 ? 1.0 : -1.0);
      directions.row(axis).swap(directions.row(2));
      const Positions points = horizontally(randomSphere(200, seed), directions);
      const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
      expectSound(points, result);
      EXPECT_EQ(result.report.coincident, 0);
      int checked = 0;
      const int bad =
          sidesToFlip(points, result.triangles, Eigen::Vector3d::Unit(axis), 200, checked);
      EXPECT_GT(checked, 4000);
      EXPECT_LE(bad, checked / 100);
    }
}

// A grid is nothing but ties, on circles and on lines; its Delaunay triangles are halves of cells.
TEST(IncrementalTriangulation, ExactGridIsTriangulatedInHalvesOfCells) {
  const int m = 15;
  const IntegerCluster grid = integerGrid(m, 0, 0);
  Positions points = horizontally(grid.directions(-1.0), randomSphere(50, 3));
  points = horizontally(points, Eigen::Vector3d::UnitZ());
  SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
  expectSound(points, result);
  flipOrientation(result.triangles);
  const auto halves = grid.smallOf(result.triangles);
  int in_cells = 0;
  for (const auto& t : halves)
    if (grid.area(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                  static_cast<std::size_t>(t[2])) == 1024 * 1024)
      ++in_cells;
  EXPECT_EQ(in_cells, 2 * 4 * m * m);
}

// Few cells of a grid, taken at random, put most points on lines through others, on the hull too.
TEST(IncrementalTriangulation, IsDelaunayOnRandomSubsetsOfAGrid) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<int> cell(0, 2 + static_cast<int>(seed % 5));
    std::set<std::array<std::int64_t, 2>> cells;
    for (int i = 0; i < 4 + static_cast<int>(seed % 17); ++i)
      cells.insert({1024 * cell(random), 1024 * cell(random)});
    if (cells.size() < 3)
      continue;
    IntegerCluster cluster;
    cluster.places.assign(cells.begin(), cells.end());
    std::shuffle(cluster.places.begin(), cluster.places.end(), random);
    const Positions points = horizontally(cluster.directions(-1.0), Eigen::Vector3d::UnitZ());
    const Index pole = static_cast<Index>(points.cols()) - 1;
    SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
    expectSound(points, result);
    flipOrientation(result.triangles);
    std::int64_t area = 0;
    for (const auto& t : test::canonical(result.triangles)) {
      if (std::max({t[0], t[1], t[2]}) == pole)
        continue;
      const auto a = static_cast<std::size_t>(t[0]);
      const auto b = static_cast<std::size_t>(t[1]);
      const auto c = static_cast<std::size_t>(t[2]);
      area += cluster.area(a, b, c);
      // On one line, both sides of the polygon are flat.
      ASSERT_GE(cluster.area(a, b, c), 0);
      for (std::size_t d = 0; d < cluster.places.size(); ++d)
        if (cluster.area(a, b, c) > 0) {
          ASSERT_LE(cluster.inCircle(a, b, c, d), 0);
        }
    }
    // Either all triangles or none are flat: a flat one between others would not be Delaunay.
    for (const auto& t : test::canonical(result.triangles))
      if (area > 0 && std::max({t[0], t[1], t[2]}) < pole) {
        ASSERT_GT(cluster.area(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                               static_cast<std::size_t>(t[2])),
                  0);
      }
  }
}

// Within rounding of a line, some triples are on it and some are not.
TEST(IncrementalTriangulation, GreatCircleWithinRoundingIsTriangulatedWhole) {
  for (const Index n : {1000, 30000}) {
    Positions points(3, n);
    for (Index i = 0; i < n; ++i) {
      const double angle = 2.0 * test::kPi * i / n;
      points.col(i) << std::sin(angle), std::cos(angle), 0.0;
    }
    expectSound(points, triangulateSphere(points, {Method::Incremental}));
  }
}

// Circles through the pole are lines in the plane.
TEST(IncrementalTriangulation, CirclesThroughThePoleAreTriangulatedWhole) {
  for (const Index n : {4, 5, 6, 7, 8, 99, 1000})
    for (const double tilt : {0.0, 0.4}) {
      Positions points(3, n);
      for (Index i = 0; i < n; ++i) {
        const double angle = 2.0 * test::kPi * i / n;
        points.col(i) << std::sin(angle) * std::cos(tilt), std::sin(tilt),
            std::cos(angle) * std::cos(tilt);
      }
      const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
      expectSound(points, result);
      if (tilt == 0.0) {
        // All points are on one line: a zigzag on either side.
        EXPECT_LE(highestDegree(result.triangles, n), 6);
      }
      // And with few points that are not on it, put in last.
      points = horizontally(points, Eigen::Vector3d(0.0, -1.0, 0.0));
      expectSound(points, triangulateSphere(points, {Method::Incremental}));
      points = horizontally(points, Eigen::Vector3d(0.0, 1.0, 0.0));
      expectSound(points, triangulateSphere(points, {Method::Incremental}));
    }
}

// Every way to put 4, 5 or 6 points to 6 places, some on one circle.
TEST(IncrementalTriangulation, FewPlacesAreTriangulatedWhole) {
  Positions places(3, 6);
  places << 0, 1, 0, 0, 0.6, -1,  //
      0, 0, 1, 0, 0, 0,           //
      1, 0, 0, -1, 0.8, 0;
  for (const Index n : {4, 5, 6}) {
    const auto ways = static_cast<int>(std::lround(std::pow(6.0, n)));
    for (int way = 0; way < ways; ++way) {
      Positions points(3, n);
      std::set<int> used;
      int rest = way;
      for (Index i = 0; i < n; ++i, rest /= 6) {
        used.insert(rest % 6);
        points.col(i) = places.col(rest % 6);
      }
      const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
      ASSERT_TRUE(isSphereOverAll(result.triangles, n)) << n << " points, way " << way;
      ASSERT_EQ(result.report.coincident, n - static_cast<Index>(used.size()));
      if (used.size() == 6) {
        ASSERT_GT(test::volumeOf(points, result.triangles), 0.0);
      }
    }
  }
}

// Distances from the pole, and from its antipode, from 1/2 down to the smallest doubles.
TEST(IncrementalTriangulation, DistancesFromThePoleSpanTheRangeOfDouble) {
  Positions points = randomSphere(50, 1);
  for (int k = 1; k < 1074; ++k) {
    const double d = std::ldexp(1.0, -k);
    Positions ring(3, 3);
    ring << d, -0.5 * d, -0.75 * d,  //
        0.125 * d, d, -d,            //
        1.0, 1.0, 1.0;
    ring.colwise().normalize();
    points = horizontally(points, ring);
  }
  for (const double z : {1.0, -1.0}) {
    points.row(2) *= z;
    const SphereTriangulation result =
        triangulateSphere(horizontally(points, Eigen::Vector3d::UnitZ()), {Method::Incremental});
    expectSound(horizontally(points, Eigen::Vector3d::UnitZ()), result);
    // From about 2^-200 on they coincide: beyond that, predicates would leave the range of double.
    EXPECT_LT(result.report.coincident, 3 * (1074 - 195));
    EXPECT_GT(result.report.coincident, 3 * (1074 - 210));
  }
}

// Vertices at one place do not crowd round one of them.
TEST(IncrementalTriangulation, PointsAtOnePlaceShareItsTriangles) {
  const Positions points =
      horizontally(randomSphere(100, 3), Positions(randomSphere(100, 3).col(5).replicate(1, 1000)));
  const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
  expectSound(points, result);
  EXPECT_EQ(result.report.coincident, 1000);
  EXPECT_EQ(result.report.reinserted, 1000);
  EXPECT_LE(highestDegree(result.triangles, static_cast<Index>(points.cols())), 40);
}

// All in caps smaller than the cells of the curve: a walk through them stays short.
TEST(IncrementalTriangulation, CrowdsAreTriangulatedInTime) {
  for (const double radius : {1e-3, 1e-7, 1e-11}) {
    const Positions points = cap(200000, radius, {0.6, 0.0, 0.8}, 2);
    const SphereTriangulation result = triangulateSphere(points, {Method::Incremental});
    EXPECT_EQ(result.triangles.cols(), 2 * points.cols() - 4);
  }
}

TEST_P(EveryMethod, ProgressIsReportedAndCancels) {
  const bool is_fast = GetParam() == TriangulationMethod::Incremental;
  const Positions directions = randomSphere(is_fast ? 300000 : 3000, 9);
  const auto run = [&](const std::function<bool(double)>& progress) {
    TriangulationOptions options;
    options.method = GetParam();
    return triangulateSphere(directions, options, test::reportingTo(progress));
  };
  const std::vector<double> fractions = test::fractionsOf(run);
  EXPECT_TRUE(test::areFractions(fractions));
  EXPECT_GE(fractions.size(), is_fast ? 8U : 2U);
  EXPECT_EQ(run([](double) { return true; }).triangles,
            triangulateSphere(directions, {GetParam()}).triangles);
  for (const int last : {1, 2, static_cast<int>(fractions.size())}) {
    int count = 0;
    EXPECT_THROW(run([&](double) { return ++count < last; }), Cancelled);
    EXPECT_EQ(count, last);
  }
}

}  // namespace
}  // namespace spherical_param
