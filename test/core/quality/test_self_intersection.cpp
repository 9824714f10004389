#include "spherical_param/self_intersection.h"

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/sphere_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace spherical_param {
namespace {

using Pairs = std::vector<std::array<Index, 2>>;

struct Mesh {
  Positions points;
  Triangles triangles;
};

Mesh make(std::initializer_list<std::array<double, 3>> points,
          std::initializer_list<std::array<Index, 3>> triangles) {
  Mesh mesh{Positions(3, static_cast<Eigen::Index>(points.size())),
            Triangles(3, static_cast<Eigen::Index>(triangles.size()))};
  Eigen::Index i = 0;
  for (const auto& point : points)
    mesh.points.col(i++) << point[0], point[1], point[2];
  i = 0;
  for (const auto& triangle : triangles)
    mesh.triangles.col(i++) << triangle[0], triangle[1], triangle[2];
  return mesh;
}

Pairs pairsOf(const Mesh& mesh, int threads = 1) {
  return findSelfIntersections(mesh.points, mesh.triangles, test::onThreads(threads));
}

/// Two triangles without a common vertex.
bool meet(const std::array<std::array<double, 3>, 3>& a,
          const std::array<std::array<double, 3>, 3>& b) {
  const Mesh mesh = make({a[0], a[1], a[2], b[0], b[1], b[2]}, {{0, 1, 2}, {3, 4, 5}});
  return !pairsOf(mesh).empty();
}

/// Two triangles {0, 1, 2} and {0, 3, 4} that share vertex 0.
bool meetBesidesVertex(std::initializer_list<std::array<double, 3>> points) {
  return !pairsOf(make(points, {{0, 1, 2}, {0, 3, 4}})).empty();
}

/// Two triangles {0, 1, 2} and {1, 0, 3} that share a side.
bool folded(std::initializer_list<std::array<double, 3>> points) {
  return !pairsOf(make(points, {{0, 1, 2}, {1, 0, 3}})).empty();
}

// --- The cases of the definition, by hand --------------------------------------------------------

constexpr std::array<std::array<double, 3>, 3> kFlat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(SelfIntersection, CrossingTrianglesIntersect) {
  EXPECT_TRUE(meet(kFlat, {{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}}));
  EXPECT_FALSE(meet(kFlat, {{{3, 3, -1}, {3, 3, 1}, {9, 9, 1}}}));
  // The boxes overlap, and each crosses the other's plane.
  EXPECT_FALSE(meet(kFlat, {{{3, 2, -1}, {3, 2, 1}, {2, 3, 1}}}));
}

TEST(SelfIntersection, TouchingIsIntersecting) {
  EXPECT_TRUE(meet(kFlat, {{{1, 1, 0}, {1, 1, 1}, {2, 1, 1}}}));    // a corner inside
  EXPECT_TRUE(meet(kFlat, {{{2, 2, 0}, {2, 2, 1}, {3, 3, 1}}}));    // a corner on a side
  EXPECT_TRUE(meet(kFlat, {{{1, 0, -1}, {1, 0, 1}, {1, -1, 0}}}));  // side across a side
  EXPECT_TRUE(meet(kFlat, {{{1, 0, 0}, {3, 0, 0}, {2, 0, 1}}}));    // a side along a side
  EXPECT_TRUE(meet(kFlat, {{{5, 0, 0}, {3, 0, 0}, {2, -1, 1}}}));   // the same, beyond its end
  EXPECT_FALSE(meet(kFlat, {{{5, 0, 0}, {6, 0, 0}, {5, -1, 1}}}));
}

TEST(SelfIntersection, CoplanarTrianglesIntersectWhereTheyOverlapOrTouch) {
  EXPECT_TRUE(meet(kFlat, {{{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}}));
  EXPECT_TRUE(meet(kFlat, {{{0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}}}));  // inside
  EXPECT_TRUE(meet(kFlat, {{{-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}}}));    // around
  EXPECT_TRUE(meet(kFlat, {{{-1, 1, 0}, {5, 1, 0}, {-1, 1.5, 0}}}));      // no corner in another
  EXPECT_TRUE(meet(kFlat, {{{-1, 0, 0}, {5, 0, 0}, {2, -1, 0}}}));        // along a side
  EXPECT_TRUE(meet(kFlat, {{{2, 2, 0}, {5, 5, 0}, {5, 4, 0}}}));          // a corner on a side
  EXPECT_FALSE(meet(kFlat, {{{3, 3, 0}, {5, 5, 0}, {5, 4, 0}}}));
  EXPECT_FALSE(meet(kFlat, {{{5, 0, 0}, {9, 0, 0}, {7, -1, 0}}}));  // on one line, apart
  EXPECT_FALSE(meet(kFlat, {{{1, 1, 1}, {5, 1, 1}, {1, 5, 1}}}));   // parallel
}

TEST(SelfIntersection, CommonVertexAloneIsNoIntersection) {
  EXPECT_FALSE(meetBesidesVertex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}));
  EXPECT_FALSE(meetBesidesVertex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {1, 1, 2}}));
  // Both cross the other's plane, elsewhere.
  EXPECT_FALSE(meetBesidesVertex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 2, -1}, {-1, 2, 1}}));
}

TEST(SelfIntersection, TrianglesThatPierceBesidesACommonVertexIntersect) {
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}}));
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {9, 9, -1}, {9, 9, 1}}));
  EXPECT_TRUE(
      meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 1}}));  // touches
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 0, 0}, {2, -1, 1}}));
}

TEST(SelfIntersection, CoplanarTrianglesWithACommonVertexIntersectWhereTheyOverlap) {
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 1, 0}, {1, 2, 0}}));
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 1, 0}, {4, -1, 0}}));
  EXPECT_TRUE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 0, 0}, {2, -1, 0}}));
  EXPECT_FALSE(meetBesidesVertex({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, -1, 0}, {3, -2, 0}}));
}

TEST(SelfIntersection, NeighboursIntersectOnlyIfFoldedFlat) {
  EXPECT_FALSE(folded({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}));
  EXPECT_TRUE(folded({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 2, 0}}));
  EXPECT_FALSE(folded({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 2, 1e-100}}));
  // The same in a tilted plane, where the last digit decides.
  const double above = std::nextafter(0.5, 1.0);
  const double below = std::nextafter(0.5, 0.0);
  EXPECT_TRUE(folded({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.25, 0.25, 0.5}}));
  EXPECT_FALSE(folded({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.25, 0.25, above}}));
  EXPECT_FALSE(folded({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.25, 0.25, below}}));
}

// A corner on a grid of neighbouring doubles around the plane z = x + y, tilted so that no product
// is exact: plain evaluation mistakes most of the grid.
TEST(SelfIntersection, NeighbouringDoublesAreDistinguished) {
  const double step = std::ldexp(1.0, -52);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      for (int k = 0; k < 32; ++k) {
        const std::array<double, 3> p{0.5 + i * step, 0.25 + j * step, 0.75 + k * step};
        ASSERT_EQ(folded({{13, 1, 14}, {1, 13, 14}, {0, 0, 0}, p}), k == i + j);
        ASSERT_EQ(meet({{{13, 1, 14}, {1, 13, 14}, {0, 0, 0}}}, {{p, {1, 1, 20}, {2, 1, 20}}}),
                  k <= i + j);
        ASSERT_EQ(meetBesidesVertex({{13, 1, 14}, {1, 13, 14}, {0, 0, 0}, p, {12, 1, 20}}),
                  k <= i + j);
      }
}

TEST(SelfIntersection, LastDigitDecidesAboutTouching) {
  const auto apex_at = [](double z) {
    return meet({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {{{0.25, 0.25, z}, {1, 1, 2}, {1, 2, 1}}});
  };
  EXPECT_TRUE(apex_at(0.5));
  EXPECT_TRUE(apex_at(std::nextafter(0.5, 0.0)));
  EXPECT_FALSE(apex_at(std::nextafter(0.5, 1.0)));
  // Beside the border of a triangle: (1/3, 2/3) is not on the line x + y = 1, but beside it.
  const auto beside = [](double x) {
    return meet({{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}}, {{{x, 0.75, 0}, {1, 1, 2}, {1, 2, 1}}});
  };
  EXPECT_TRUE(beside(0.25));
  EXPECT_TRUE(beside(std::nextafter(0.25, 0.0)));
  EXPECT_FALSE(beside(std::nextafter(0.25, 1.0)));
}

TEST(SelfIntersection, RepeatedTrianglesIntersect) {
  const Mesh mesh = make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}});
  EXPECT_EQ(pairsOf(mesh), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
}

TEST(SelfIntersection, EqualPositionsAreTheSameVertex) {
  // Neighbours over a side whose ends are stored twice, and -0 is 0.
  EXPECT_FALSE(meet(kFlat, {{{4, -0.0, 0}, {0, 0, -0.0}, {0, -4, 0}}}));
  EXPECT_TRUE(meet(kFlat, {{{4, 0, 0}, {0, 0, 0}, {0, 5, 0}}}));
  EXPECT_FALSE(meet(kFlat, {{{0, 0, 0}, {-1, 0, 0}, {0, -4, 0}}}));
  EXPECT_TRUE(meet(kFlat, {{{0, 0, 0}, {1, 1, 0}, {0, -4, 0}}}));
  EXPECT_TRUE(meet(kFlat, kFlat));
  EXPECT_FALSE(folded({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}}));  // second has no area
  EXPECT_TRUE(folded({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}}));
}

TEST(SelfIntersection, TrianglesWithoutAreaAreLeftOut) {
  EXPECT_FALSE(meet(kFlat, {{{1, 1, -1}, {1, 1, 0}, {1, 1, 1}}}));
  EXPECT_FALSE(meet(kFlat, {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}}));
  const Mesh mesh = make({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}}, {{0, 1, 2}, {0, 0, 1}});
  EXPECT_TRUE(pairsOf(mesh).empty());
}

TEST(SelfIntersection, EmptyMeshHasNone) {
  EXPECT_TRUE(findSelfIntersections(Positions(3, 0), Triangles(3, 0)).empty());
  EXPECT_TRUE(findSelfIntersections(test::spiralSphere(9), Triangles(3, 0)).empty());
}

// --- An oracle: all pairs, separating axes in integers
// --------------------------------------------

__extension__ using Wide = __int128;
using Whole = std::array<std::int64_t, 3>;  ///< exact below 2^30
using WideVector = std::array<Wide, 3>;

struct WholeMesh {
  std::vector<Whole> points;
  std::vector<std::array<Index, 3>> triangles;
};

WideVector minus(const Whole& a, const Whole& b) {
  return {Wide{a[0]} - b[0], Wide{a[1]} - b[1], Wide{a[2]} - b[2]};
}
WideVector cross(const WideVector& a, const WideVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Wide dot(const WideVector& a, const Whole& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
bool isZero(const WideVector& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

/// Whether the convex hulls of two sets of points, segments or triangles with area, are disjoint:
/// then one of the normals of the facets of their Minkowski difference separates them (S.
/// Gottschalk, M. Lin and D. Manocha, "OBBTree", 1996).
bool apart(const std::vector<Whole>& a, const std::vector<Whole>& b) {
  std::vector<WideVector> axes;
  std::vector<WideVector> sides;
  std::vector<WideVector> normals;
  for (const auto* hull : {&a, &b}) {
    for (std::size_t i = 0; i < hull->size(); ++i)
      sides.push_back(minus((*hull)[(i + 1) % hull->size()], (*hull)[i]));
    if (hull->size() == 3)
      normals.push_back(cross(minus((*hull)[1], (*hull)[0]), minus((*hull)[2], (*hull)[0])));
  }
  axes = normals;
  for (const WideVector& side : sides) {
    for (const WideVector& other : sides)
      axes.push_back(cross(side, other));
    for (const WideVector& normal : normals)
      axes.push_back(cross(normal, side));
  }
  return std::any_of(axes.begin(), axes.end(), [&](const WideVector& axis) {
    const auto order = [&](const Whole& p, const Whole& q) { return dot(axis, p) < dot(axis, q); };
    const auto [a_low, a_high] = std::minmax_element(a.begin(), a.end(), order);
    const auto [b_low, b_high] = std::minmax_element(b.begin(), b.end(), order);
    return order(*a_high, *b_low) || order(*b_high, *a_low);
  });
}

bool expected(const WholeMesh& mesh, std::size_t s, std::size_t t) {
  std::vector<Whole> a;
  std::vector<Whole> b;
  for (const Index v : mesh.triangles[s])
    a.push_back(mesh.points[static_cast<std::size_t>(v)]);
  for (const Index v : mesh.triangles[t])
    b.push_back(mesh.points[static_cast<std::size_t>(v)]);
  for (const auto* triangle : {&a, &b})
    if (isZero(cross(minus((*triangle)[1], (*triangle)[0]), minus((*triangle)[2], (*triangle)[0]))))
      return false;
  std::vector<Whole> common;
  std::vector<Whole> only_a;
  std::vector<Whole> only_b;
  for (const Whole& p : a)
    (std::count(b.begin(), b.end(), p) > 0 ? common : only_a).push_back(p);
  for (const Whole& p : b)
    if (std::count(a.begin(), a.end(), p) == 0)
      only_b.push_back(p);
  switch (common.size()) {
  case 0:
    return !apart(a, b);
  case 1:
    return !apart(only_a, b) || !apart(a, only_b);
  case 2: {
    // Flat: the two normals over the common side are parallel and point the same way.
    const WideVector side = minus(common[1], common[0]);
    const WideVector normal_a = cross(side, minus(only_a[0], common[0]));
    const WideVector normal_b = cross(side, minus(only_b[0], common[0]));
    return isZero(cross(normal_a, normal_b)) &&
           normal_a[0] * normal_b[0] + normal_a[1] * normal_b[1] + normal_a[2] * normal_b[2] > 0;
  }
  default:
    return true;
  }
}

Pairs bruteForce(const WholeMesh& mesh) {
  Pairs pairs;
  for (std::size_t s = 0; s < mesh.triangles.size(); ++s)
    for (std::size_t t = s + 1; t < mesh.triangles.size(); ++t)
      if (expected(mesh, s, t))
        pairs.push_back({static_cast<Index>(s), static_cast<Index>(t)});
  return pairs;
}

Mesh inUnits(const WholeMesh& whole, double unit) {
  Mesh mesh{Positions(3, static_cast<Eigen::Index>(whole.points.size())),
            Triangles(3, static_cast<Eigen::Index>(whole.triangles.size()))};
  for (std::size_t i = 0; i < whole.points.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      mesh.points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)) =
          static_cast<double>(whole.points[i][axis]) * unit;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t)
    mesh.triangles.col(static_cast<Eigen::Index>(t)) << whole.triangles[t][0],
        whole.triangles[t][1], whole.triangles[t][2];
  return mesh;
}

/// Triangles over common points of a grid of so many steps: full of ties of every kind.
WholeMesh randomSoup(std::mt19937_64& random, int points, int triangles, std::int64_t steps) {
  std::uniform_int_distribution<std::int64_t> coordinate(0, steps);
  std::uniform_int_distribution<Index> vertex(0, points - 1);
  WholeMesh mesh;
  for (int i = 0; i < points; ++i)
    mesh.points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  for (int i = 0; i < triangles; ++i)
    mesh.triangles.push_back({vertex(random), vertex(random), vertex(random)});
  return mesh;
}

TEST(SelfIntersection, PairsAreThoseOfIntegerArithmetic) {
  std::mt19937_64 random(1);
  std::size_t count = 0;
  for (int round = 0; round < 1000; ++round) {
    const std::int64_t steps =
        std::array<std::int64_t, 5>{1, 2, 4, 8, 1 << 29}[static_cast<std::size_t>(round) % 5];
    const WholeMesh mesh = randomSoup(random, 6 + round % 9, 18, steps);
    const Pairs pairs = bruteForce(mesh);
    count += pairs.size();
    ASSERT_EQ(pairsOf(inUnits(mesh, 1.0)), pairs) << "round " << round;
  }
  EXPECT_GT(count, 10000U);
}

TEST(SelfIntersection, FlatMeshesAreThoseOfIntegerArithmetic) {
  // In the plane x + 2 y - 3 z = 0 and near it.
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::int64_t> coordinate(-50, 50);
  std::uniform_int_distribution<Index> vertex(0, 19);
  for (int round = 0; round < 60; ++round) {
    WholeMesh mesh;
    for (int i = 0; i < 20; ++i) {
      const std::int64_t y = coordinate(random);
      const std::int64_t z = coordinate(random);
      mesh.points.push_back({3 * z - 2 * y, y, z + (round % 3 == 2 && i % 5 == 0 ? 1 : 0)});
    }
    for (int i = 0; i < 25; ++i)
      mesh.triangles.push_back({vertex(random), vertex(random), vertex(random)});
    ASSERT_EQ(pairsOf(inUnits(mesh, 1.0)), bruteForce(mesh)) << "round " << round;
  }
}

/// Small triangles in a cube, some of which form a cluster; some as large as all.
WholeMesh unevenSoup(std::uint64_t seed, int small, int crowded, int large) {
  std::mt19937_64 random(seed);
  const auto within = [&](std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random);
  };
  constexpr std::int64_t extent = 1 << 29;
  WholeMesh mesh;
  const auto add = [&](const Whole& at, std::int64_t size) {
    const auto first = static_cast<Index>(mesh.points.size());
    for (int k = 0; k < 3; ++k)
      mesh.points.push_back(
          {at[0] + within(0, size), at[1] + within(0, size), at[2] + within(0, size)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  for (int i = 0; i < small; ++i)
    add({within(0, extent), within(0, extent), within(0, extent)}, extent / 8);
  for (int i = 0; i < crowded; ++i)
    add({77 + within(0, 200), 99 + within(0, 200), within(0, 200)}, 40);
  for (int i = 0; i < large; ++i)
    add({0, 0, 0}, extent);
  // The tree gains nothing from the order.
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  return mesh;
}

TEST(SelfIntersection, UnevenMeshesAreThoseOfIntegerArithmetic) {
  const WholeMesh mesh = unevenSoup(3, 200, 300, 8);
  const Pairs pairs = bruteForce(mesh);
  EXPECT_GT(pairs.size(), 50U);
  EXPECT_EQ(pairsOf(inUnits(mesh, 1.0)), pairs);
}

TEST(SelfIntersection, UnitDoesNotMatter) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 10; ++round) {
    const WholeMesh mesh = randomSoup(random, 12, 30, 6);
    const Pairs pairs = pairsOf(inUnits(mesh, 1.0));
    for (const double unit : {0x1p-1060, 0x1p-300, 0x1p-3, 0x1p40, 0x1p300, 0x1p1018})
      ASSERT_EQ(pairsOf(inUnits(mesh, unit)), pairs) << unit;
  }
}

// --- Properties of the answer --------------------------------------------------------------------

/// A tube whose ends run into each other.
Mesh knottedTube(int ring) {
  const test::Tube tube = test::bentTube(20.0, 2.2 * test::kPi, ring);
  return {tube.points, tube.triangles};
}

TEST(SelfIntersection, ConvexAndStretchedSurfacesHaveNone) {
  const test::Tube straight = test::bentTube(20.0, 0.0, 24);
  EXPECT_TRUE(findSelfIntersections(straight.points, straight.triangles).empty());
  const test::Tube bent = test::bentTube(20.0, 3.0, 24);
  EXPECT_TRUE(findSelfIntersections(bent.points, bent.triangles).empty());
  EXPECT_FALSE(pairsOf(knottedTube(24)).empty());
}

TEST(SelfIntersection, OrderDoesNotMatter) {
  const Mesh mesh = knottedTube(16);
  const Pairs pairs = pairsOf(mesh);
  std::mt19937_64 random(5);
  std::vector<Index> vertices(static_cast<std::size_t>(mesh.points.cols()));
  std::vector<Index> triangles(static_cast<std::size_t>(mesh.triangles.cols()));
  std::iota(vertices.begin(), vertices.end(), Index{0});
  std::iota(triangles.begin(), triangles.end(), Index{0});
  std::shuffle(vertices.begin(), vertices.end(), random);
  std::shuffle(triangles.begin(), triangles.end(), random);
  Mesh other = mesh;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    other.points.col(vertices[v]) = mesh.points.col(static_cast<Eigen::Index>(v));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)  // begun at another corner, and every other one turned over
      other.triangles(t % 2 == 0 ? k : 2 - k, triangles[t]) = vertices[static_cast<std::size_t>(
          mesh.triangles((k + static_cast<int>(t)) % 3, static_cast<Eigen::Index>(t)))];
  Pairs renamed;
  for (const auto& [s, t] : pairs) {
    const auto [low, high] =
        std::minmax(triangles[static_cast<std::size_t>(s)], triangles[static_cast<std::size_t>(t)]);
    renamed.push_back({low, high});
  }
  std::sort(renamed.begin(), renamed.end());
  EXPECT_EQ(pairsOf(other), renamed);
}

TEST(SelfIntersection, PairsAreAscendingAndNamedOnce) {
  const Pairs pairs = pairsOf(knottedTube(24));
  EXPECT_TRUE(std::adjacent_find(pairs.begin(), pairs.end(), std::greater_equal<>()) ==
              pairs.end());
  EXPECT_TRUE(
      std::all_of(pairs.begin(), pairs.end(), [](const auto& pair) { return pair[0] < pair[1]; }));
}

TEST(SelfIntersection, ThreadsDoNotMatter) {
  const Mesh mesh = knottedTube(80);
  ASSERT_GT(mesh.triangles.cols(), 30000);
  const Pairs pairs = pairsOf(mesh, 1);
  EXPECT_EQ(pairsOf(mesh, 2), pairs);
  EXPECT_EQ(pairsOf(mesh, 5), pairs);
  EXPECT_EQ(pairsOf(mesh, 0), pairs);
}

Pairs onlyOf(const Pairs& pairs, const std::vector<Index>& of) {
  Pairs result;
  for (const auto& pair : pairs)
    if (std::count(of.begin(), of.end(), pair[0]) + std::count(of.begin(), of.end(), pair[1]) > 0)
      result.push_back(pair);
  return result;
}

TEST(SelfIntersection, PairsOfASetAreThoseOfTheWholeMesh) {
  const Mesh uneven = inUnits(unevenSoup(6, 300, 300, 5), 1.0);
  const Mesh tube = knottedTube(24);
  std::mt19937_64 random(7);
  for (const Mesh& mesh : {uneven, tube}) {
    const Pairs pairs = pairsOf(mesh);
    const auto m = static_cast<Index>(mesh.triangles.cols());
    std::uniform_int_distribution<Index> triangle(0, m - 1);
    for (const int size : {0, 1, 7, 60, 400}) {
      std::vector<Index> of(static_cast<std::size_t>(size));
      std::generate(of.begin(), of.end(), [&] { return triangle(random); });
      EXPECT_EQ(findSelfIntersectionsOf(mesh.points, mesh.triangles, of), onlyOf(pairs, of))
          << size;
    }
    std::vector<Index> all(static_cast<std::size_t>(m));
    std::iota(all.rbegin(), all.rend(), Index{0});
    EXPECT_EQ(findSelfIntersectionsOf(mesh.points, mesh.triangles, all), pairs);
  }
}

TEST(SelfIntersection, ThreadsDoNotMatterForASet) {
  const Mesh mesh = knottedTube(112);
  ASSERT_GT(mesh.triangles.cols(), 60000);
  std::vector<Index> of;
  for (Index t = 0; t < mesh.triangles.cols(); t += 3)
    of.push_back(t);
  const Pairs pairs = findSelfIntersectionsOf(mesh.points, mesh.triangles, of, test::onThreads(1));
  EXPECT_FALSE(pairs.empty());
  EXPECT_EQ(findSelfIntersectionsOf(mesh.points, mesh.triangles, of, test::onThreads(3)), pairs);
}

TEST(SelfIntersection, BadInputIsInvalidInput) {
  Mesh mesh = make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  EXPECT_THROW(pairsOf(mesh, -1), InvalidInput);
  EXPECT_THROW(pairsOf(mesh, 1025), InvalidInput);
  EXPECT_NO_THROW(pairsOf(mesh, 1024));
  const std::vector<Index> beyond{1};
  const std::vector<Index> negative{-1};
  EXPECT_THROW(findSelfIntersectionsOf(mesh.points, mesh.triangles, beyond), InvalidInput);
  EXPECT_THROW(findSelfIntersectionsOf(mesh.points, mesh.triangles, negative), InvalidInput);
  for (const Index vertex : {-1, 3}) {
    mesh.triangles(1, 0) = vertex;
    EXPECT_THROW(pairsOf(mesh), InvalidInput);
  }
  mesh.triangles(1, 0) = 1;
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    mesh.points(2, 1) = value;
    EXPECT_THROW(pairsOf(mesh), InvalidInput);
  }
}

TEST(SelfIntersection, ProgressIsReportedAndCancels) {
  // Two spheres through each other, each of more triangles than there are between reports.
  Positions points = test::spiralSphere(140000);
  const Triangles sphere = triangulateSphere(points).triangles;
  Triangles both(3, 2 * sphere.cols());
  both << sphere, (sphere.array() + static_cast<Index>(points.cols())).matrix();
  points = test::horizontally(points, points.colwise() + Eigen::Vector3d(0.7, 0.2, 0.1));
  const std::vector<Index> some{0, 5, 100};
  for (const bool of_some : {false, true}) {
    const auto run = [&](const std::function<bool(double)>& progress) {
      const Execution options = test::reportingTo(progress);
      return of_some ? findSelfIntersectionsOf(points, both, some, options)
                     : findSelfIntersections(points, both, options);
    };
    const std::vector<double> fractions = test::fractionsOf(run);
    EXPECT_TRUE(test::areFractions(fractions));
    EXPECT_EQ(fractions.back(), 1.0);
    EXPECT_GE(fractions.size(), of_some ? 6U : 12U);
    EXPECT_EQ(run([](double) { return true; }), run({}));
    for (const int last : {1, 3, static_cast<int>(fractions.size())}) {
      int count = 0;
      EXPECT_THROW(run([&](double) { return ++count < last; }), Cancelled);
      EXPECT_EQ(count, last);
    }
  }
}

}  // namespace
}  // namespace spherical_param
