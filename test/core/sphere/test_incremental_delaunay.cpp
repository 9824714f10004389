#include "incremental_delaunay.h"

#include "exact_predicates.h"
#include "helpers.h"
#include "indexed.h"
#include "qhull.h"
#include "spherical_param/mesh_topology.h"

namespace spherical_param::test {
namespace {

/// A closed sphere over all points.
SphereDelaunay triangulate(const Positions& directions) {
  SphereDelaunay result = incrementalDelaunay(directions);
  EXPECT_EQ(result.triangles.cols(), 2 * directions.cols() - 4);
  EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(directions.cols())));
  return result;
}

/// n points on the circle of latitude of height z; the angle of point i is that of i turns of n.
Positions latitude(Index n, double z) {
  const double radius = std::sqrt(1.0 - z * z);
  return pointsAt(n, [=](Index i) { return onCircle(2.0 * kPi * i / n, radius, z); });
}

/// Most triangles around one of the vertices [0, n).
int highestDegree(const Triangles& triangles, Index n) {
  std::vector<int> degree(static_cast<std::size_t>(n), 0);
  for (const Index v : triangles.reshaped())
    ++degree[static_cast<std::size_t>(v)];
  return *std::max_element(degree.begin(), degree.end());
}

/// Points crowded into caps of radius 0.3 and 0.01.
Positions clusters(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const Positions centres = randomSphere(5, seed + 100);
  return pointsAt(n, [&](Index i) {
    const Eigen::Vector3d off(normal(random), normal(random), normal(random));
    return (centres.col(i % 5) + (i % 2 == 0 ? 0.3 : 0.01) * off).normalized();
  });
}

/// What an embedding makes of a few limbs: distances to their tips that shrink exponentially.
Positions limbs(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Positions tips = randomSphere(4, seed + 200);
  return pointsAt(n, [&](Index i) {
    const Eigen::Vector3d tip = tips.col(i % 4);
    const Eigen::Vector3d east = tip.unitOrthogonal();
    const double radius = std::exp(-7.0 * uniform(random));
    const double angle = 2.0 * kPi * uniform(random);
    return (tip + radius * (std::cos(angle) * east + std::sin(angle) * tip.cross(east)))
        .normalized();
  });
}

TEST(IncrementalDelaunay, HasTheTrianglesOfQhull) {
  int compared = 0;
  for (const Index n : {4, 5, 6, 7, 10, 30, 127, 128, 129, 1000, 3000})
    for (std::uint64_t seed = 0; seed < (n < 100 ? 20U : 2U); ++seed)
      for (const Positions& points : {randomSphere(n, seed), clusters(n, seed), limbs(n, seed),
                                      cap(n, 0.1, {1, 0, 0}, seed)}) {
        const SphereDelaunay result = triangulate(points);
        EXPECT_EQ(result.coincident, 0);
        const Triangles reference = hullByQhull(points);
        if (reference.cols() == 0)
          continue;
        ++compared;
        ASSERT_EQ(canonical(result.triangles), canonical(reference))
            << "n = " << n << ", seed " << seed;
      }
  EXPECT_GT(compared, 400);
}

// Clusters of spacing 1e-13 around the lowest or highest point of the sphere, where it is as flat
// as its tangent plane: integer points of a grid, most of them on lines through others, on the hull
// too, and the same moved a little. Around the lowest point the pole is opposite and its direction
// exact, around the highest point the pole is in the cluster.
TEST(IncrementalDelaunay, IsExactInClustersOf1em13) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const int jitter = seed % 3 == 0 ? 400 : 0;
    std::uniform_int_distribution<int> cell(-1, 1 + static_cast<int>(seed % 5));
    std::uniform_int_distribution<int> move(-jitter, jitter);
    std::set<std::pair<int, int>> cells;
    for (int i = 0; i < 4 + static_cast<int>(seed % 17); ++i)
      cells.emplace(1024 * cell(random) + move(random), 1024 * cell(random) + move(random));
    if (cells.size() < 3)
      continue;
    Indexed<Eigen::Vector2d> places;
    for (const auto& [x, y] : cells)
      places.emplace_back(x, y);
    std::shuffle(places.begin(), places.end(), random);
    // Lines are circles through the pole: where that is in the cluster, no three are on one.
    const double z = jitter > 0 && seed % 2 == 0 ? 1.0 : -1.0;
    const Index opposite = places.count();
    const Positions points = pointsAt(opposite + 1, [&](Index i) {
      return i < opposite ? Eigen::Vector3d(0x1p-53 * places[i].x(), 0x1p-53 * places[i].y(), z)
                          : Eigen::Vector3d(0.0, 0.0, -z);
    });
    SphereDelaunay result = triangulate(points);
    EXPECT_EQ(result.coincident, 0);
    // Seen from outside, the highest point has the axes the right way round.
    if (z < 0.0)
      flipOrientation(result.triangles);
    int flat = 0;
    int with_area = 0;
    for (const auto& [a, b, c] : canonical(result.triangles)) {
      if (std::max({a, b, c}) == opposite)
        continue;
      const int turn = orientation2d(places[a], places[b], places[c]);
      ASSERT_GE(turn, 0);
      ++(turn > 0 ? with_area : flat);
      for (Index d = 0; turn > 0 && d < opposite; ++d)
        ASSERT_LE(inCircle(places[a], places[b], places[c], places[d]), 0);
    }
    // On one line, both sides of the polygon are flat. Elsewhere, flat ones are not Delaunay.
    ASSERT_TRUE(flat == 0 || with_area == 0);
  }
}

// Cubes, circles within rounding of a plane, prisms, crowds that are smaller than rounding, circles
// through the pole, and places of many points.
TEST(IncrementalDelaunay, EveryPointIsAVertexWhereManyAreInOnePlaneOrPlace) {
  std::vector<Positions> all{latitude(300, 0.0), latitude(10000, 0.0),
                             horizontally(latitude(500, 0.6), latitude(500, -0.6))};
  for (const int m : {2, 3, 6, 11})
    all.push_back((cubeGrid(m).array() - 0.5).matrix().colwise().normalized());
  for (const double radius : {0.05, 1e-3, 1e-7, 1e-9, 1e-12, 1e-15}) {
    const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
    const Positions one = cap(1500, radius, pole, 2);
    for (const Positions& beside : {Positions(3, 0), cap(1500, radius, -pole, 3),
                                    cap(500, 0.05, pole, 4), randomSphere(500, 1)})
      all.push_back(horizontally(beside, one));
  }
  // Circles through the pole are lines in the plane; few points beside them are put in last.
  for (const Index n : {4, 5, 6, 99, 1000})
    for (const double tilt : {0.0, 0.4}) {
      all.emplace_back(latitude(n, std::sin(tilt))(std::vector{1, 2, 0}, Eigen::all));
      all.push_back(horizontally(all.back(), -Eigen::Vector3d::UnitY()));
    }
  const Positions some = randomSphere(100, 3);
  const Positions place = some.col(5).replicate(1, 1000);
  all.push_back(horizontally(some, some));
  all.push_back(place);
  all.push_back(horizontally(place, some.col(6).replicate(1, 50)));
  for (const Positions& points : all)
    triangulate(points);
  // A prism of two regular n-gons: nothing else is convex.
  EXPECT_NEAR(volumeOf(all[2], triangulate(all[2]).triangles),
              1.2 * 0.5 * 500 * 0.64 * std::sin(2.0 * kPi / 500), 1e-9);
  // Vertices at one place do not crowd round one of them.
  const SphereDelaunay result = triangulate(horizontally(some, place));
  EXPECT_EQ(result.coincident, 1000);
  EXPECT_LE(highestDegree(result.triangles, 1100), 40);
}

// Every way to put 4, 5 or 6 points to 6 places, some on one circle.
TEST(IncrementalDelaunay, FewPlacesAreTriangulatedWhole) {
  const Positions places{{0, 1, 0, 0, 0.6, -1}, {0, 0, 1, 0, 0, 0}, {1, 0, 0, -1, 0.8, 0}};
  for (const auto& [n, ways] : {std::pair(4, 1296), std::pair(5, 7776), std::pair(6, 46656)})
    for (int way = 0; way < ways; ++way) {
      Positions points(3, n);
      std::set<int> used;
      int rest = way;
      for (Index i = 0; i < n; ++i, rest /= 6) {
        used.insert(rest % 6);
        points.col(i) = places.col(rest % 6);
      }
      const SphereDelaunay result = triangulate(points);
      ASSERT_FALSE(HasFailure()) << n << " points, way " << way;
      ASSERT_EQ(result.coincident, n - static_cast<Index>(used.size()));
      if (used.size() == 6) {
        ASSERT_GT(volumeOf(points, result.triangles), 0.0);
      }
    }
}

// Distances from the pole, and from its antipode, from 1/2 down to the smallest doubles.
TEST(IncrementalDelaunay, DistancesFromThePoleSpanTheRangeOfDouble) {
  Positions points = randomSphere(50, 1);
  for (int k = 1; k < 1074; ++k) {
    const double d = std::ldexp(1.0, -k);
    const Positions ring{{d, -0.5 * d, -0.75 * d}, {0.125 * d, d, -d}, {1.0, 1.0, 1.0}};
    points = horizontally(points, ring.colwise().normalized());
  }
  for (const double z : {1.0, -1.0}) {
    points.row(2) *= z;
    const SphereDelaunay result = triangulate(horizontally(points, Eigen::Vector3d::UnitZ()));
    // From about 2^-200 on they coincide: beyond that, predicates would leave the range of double.
    EXPECT_LT(result.coincident, 3 * (1074 - 195));
    EXPECT_GT(result.coincident, 3 * (1074 - 210));
  }
}

}  // namespace
}  // namespace spherical_param::test
