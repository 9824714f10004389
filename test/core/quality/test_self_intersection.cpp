#include "spherical_param/self_intersection.h"

#include "helpers.h"
#include "spherical_param/errors.h"

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
using Corners = std::array<std::array<double, 3>, 3>;

struct Mesh {
  Positions points;
  Triangles triangles;
};

Pairs pairsOf(const Mesh& mesh, int threads = 1) {
  return findSelfIntersections(mesh.points, mesh.triangles, test::onThreads(threads));
}

/// Whether two triangles, which share the vertices of equal positions, intersect.
bool meet(const Corners& a, const Corners& b) {
  Mesh mesh{Positions(3, 6), Triangles(3, 2)};
  for (Index i = 0; i < 3; ++i)
    for (Index axis = 0; axis < 3; ++axis) {
      const auto corner = static_cast<std::size_t>(i);
      mesh.points(axis, i) = a[corner][static_cast<std::size_t>(axis)];
      mesh.points(axis, i + 3) = b[corner][static_cast<std::size_t>(axis)];
    }
  mesh.triangles << 0, 3, 1, 4, 2, 5;
  const bool result = !pairsOf(mesh).empty();
  // The same with the numbers of the first for its vertices.
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j)
      if (mesh.points.col(i) == mesh.points.col(3 + j))
        mesh.triangles(j, 1) = i;
  EXPECT_EQ(!pairsOf(mesh).empty(), result);
  return result;
}

TEST(SelfIntersection, TrianglesIntersectAsDefined) {
  const Corners flat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  const auto expect = [&](bool expected, const char* what, const Corners& other) {
    EXPECT_EQ(meet(flat, other), expected) << what;
    EXPECT_EQ(meet(other, flat), expected) << what;
  };
  // Without a common vertex: a point in common.
  expect(true, "pierces", {{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}});
  expect(false, "crosses the plane elsewhere", {{{3, 2, -1}, {3, 2, 1}, {2, 3, 1}}});
  expect(true, "touches with a corner", {{{2, 2, 0}, {2, 2, 1}, {3, 3, 1}}});
  expect(true, "side along a side, beyond its end", {{{5, 0, 0}, {3, 0, 0}, {2, -1, 1}}});
  expect(false, "on the line of a side, apart", {{{5, 0, 0}, {6, 0, 0}, {5, -1, 1}}});
  expect(true, "in the plane, around", {{{-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}}});
  expect(true, "in the plane, no corner inside", {{{-1, 1, 0}, {5, 1, 0}, {-1, 1.5, 0}}});
  expect(false, "in the plane, apart", {{{3, 3, 0}, {5, 5, 0}, {5, 4, 0}}});
  expect(false, "parallel", {{{1, 1, 1}, {5, 1, 1}, {1, 5, 1}}});
  // One: the opposite side meets the other triangle. -0 is 0.
  expect(false, "touches there alone", {{{0, -0.0, 0}, {-1, 2, -1}, {-1, 2, 1}}});
  expect(true, "pierces besides", {{{-0.0, 0, 0}, {1, 1, -1}, {1, 1, 1}}});
  expect(true, "in the plane, overlaps", {{{0, 0, 0}, {4, 1, 0}, {4, -1, 0}}});
  expect(false, "in the plane, beside", {{{0, 0, 0}, {4, -1, 0}, {3, -2, 0}}});
  // Two: folded flat onto each other.
  expect(false, "neighbours", {{{4, 0, 0}, {0, 0, -0.0}, {0, -4, 0}}});
  expect(true, "folded", {{{4, 0, 0}, {0, 0, 0}, {4, 9, 0}}});
  expect(false, "nearly folded", {{{4, 0, 0}, {0, 0, 0}, {4, 9, 1e-100}}});
  // Three.
  expect(true, "equal", flat);
  // No area.
  expect(false, "on one line", {{{1, 1, -1}, {1, 1, 0}, {1, 1, 1}}});
}

// A corner on a grid of neighbouring doubles around the plane z = x + y, tilted so that no product
// is exact: plain evaluation mistakes most of the grid.
TEST(SelfIntersection, NeighbouringDoublesAreDistinguished) {
  const double step = std::ldexp(1.0, -52);
  const Corners tilted{{{13, 1, 14}, {1, 13, 14}, {0, 0, 0}}};
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      for (int k = 0; k < 24; ++k) {
        const std::array<double, 3> p{0.5 + i * step, 0.25 + j * step, 0.75 + k * step};
        ASSERT_EQ(meet(tilted, {{{1, 13, 14}, {13, 1, 14}, p}}), k == i + j);  // folded
        ASSERT_EQ(meet(tilted, {{p, {1, 1, 20}, {2, 1, 20}}}), k <= i + j);
        ASSERT_EQ(meet(tilted, {{{13, 1, 14}, p, {12, 1, 20}}}), k <= i + j);
      }
}

// --- An oracle: all pairs, separating axes in integers -------------------------------------------

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
/// Gottschalk, M. Lin and D. Manocha, "OBBTree", 1996). The coordinate axes find most of them.
bool apart(const std::vector<Whole>& a, const std::vector<Whole>& b) {
  const auto separates = [&](const WideVector& axis) {
    const auto order = [&](const Whole& p, const Whole& q) { return dot(axis, p) < dot(axis, q); };
    const auto [a_low, a_high] = std::minmax_element(a.begin(), a.end(), order);
    const auto [b_low, b_high] = std::minmax_element(b.begin(), b.end(), order);
    return order(*a_high, *b_low) || order(*b_high, *a_low);
  };
  if (separates({1, 0, 0}) || separates({0, 1, 0}) || separates({0, 0, 1}))
    return true;
  std::vector<WideVector> sides;
  std::vector<WideVector> normals;
  for (const auto* hull : {&a, &b}) {
    for (std::size_t i = 0; i < hull->size(); ++i)
      sides.push_back(minus((*hull)[(i + 1) % hull->size()], (*hull)[i]));
    if (hull->size() == 3)
      normals.push_back(cross(minus((*hull)[1], (*hull)[0]), minus((*hull)[2], (*hull)[0])));
  }
  std::vector<WideVector> axes = normals;
  for (const WideVector& side : sides) {
    for (const WideVector& other : sides)
      axes.push_back(cross(side, other));
    for (const WideVector& normal : normals)
      axes.push_back(cross(normal, side));
  }
  return std::any_of(axes.begin(), axes.end(), separates);
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
    WholeMesh mesh = randomSoup(random, 6 + round % 9, 18, steps);
    if (round % 10 < 2)  // in the plane x + 2 y - 3 z = 0, but for one point in some
      for (std::size_t i = round % 20 < 10 ? 1 : 0; i < mesh.points.size(); ++i)
        mesh.points[i][0] = 3 * mesh.points[i][2] - 2 * mesh.points[i][1];
    const Pairs pairs = bruteForce(mesh);
    count += pairs.size();
    ASSERT_EQ(pairsOf(inUnits(mesh, 1.0)), pairs) << "round " << round;
    if (round % 99 != 98)
      continue;
    for (const double unit : {0x1p-1060, 0x1p-300, 0x1p-3, 0x1p40, 0x1p300, 0x1p990})
      ASSERT_EQ(pairsOf(inUnits(mesh, unit)), pairs) << unit;
  }
  EXPECT_GT(count, 10000U);
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

/// A tube whose ends run into each other, on a grid of 2^-20, in units of that.
WholeMesh knottedTube(int ring) {
  const test::Tube tube = test::bentTube(20.0, 2.2 * test::kPi, ring);
  WholeMesh mesh;
  for (Eigen::Index i = 0; i < tube.points.cols(); ++i)
    mesh.points.push_back({std::llround(std::ldexp(tube.points(0, i), 20)),
                           std::llround(std::ldexp(tube.points(1, i), 20)),
                           std::llround(std::ldexp(tube.points(2, i), 20))});
  for (Eigen::Index t = 0; t < tube.triangles.cols(); ++t)
    mesh.triangles.push_back({tube.triangles(0, t), tube.triangles(1, t), tube.triangles(2, t)});
  return mesh;
}

TEST(SelfIntersection, PairsOfLargeMeshesAreThoseOfIntegerArithmetic) {
  for (const WholeMesh& mesh : {unevenSoup(3, 200, 300, 8), knottedTube(14)}) {
    const Pairs pairs = bruteForce(mesh);
    EXPECT_GT(pairs.size(), 50U);
    EXPECT_EQ(pairsOf(inUnits(mesh, 1.0)), pairs);
  }
}

TEST(SelfIntersection, OrderDoesNotMatter) {
  const Mesh mesh = inUnits(knottedTube(24), 1.0);
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
  for (const auto& [s, t] : pairsOf(mesh)) {
    const auto [low, high] =
        std::minmax(triangles[static_cast<std::size_t>(s)], triangles[static_cast<std::size_t>(t)]);
    renamed.push_back({low, high});
  }
  std::sort(renamed.begin(), renamed.end());
  EXPECT_EQ(pairsOf(other), renamed);
}

TEST(SelfIntersection, PairsOfASetAreThoseOfTheWholeMeshOnAnyNumberOfThreads) {
  // The tube has more triangles than a single thread is left with.
  std::mt19937_64 random(7);
  for (const WholeMesh& whole : {unevenSoup(6, 300, 300, 5), knottedTube(86)}) {
    const Mesh mesh = inUnits(whole, 1.0);
    const Pairs pairs = pairsOf(mesh);
    EXPECT_GT(pairs.size(), 50U);
    EXPECT_EQ(pairsOf(mesh, 3), pairs);
    const auto m = static_cast<Index>(mesh.triangles.cols());
    std::uniform_int_distribution<Index> triangle(0, m - 1);
    for (const Index size : {0, 1, 7, 60, 400, m}) {
      std::vector<Index> of(static_cast<std::size_t>(size));
      std::generate(of.begin(), of.end(), [&] { return triangle(random); });
      std::vector<char> is_of(static_cast<std::size_t>(m), 0);
      for (const Index t : of)
        is_of[static_cast<std::size_t>(t)] = 1;
      Pairs expected_pairs;
      for (const auto& pair : pairs)
        if (is_of[static_cast<std::size_t>(pair[0])] + is_of[static_cast<std::size_t>(pair[1])] > 0)
          expected_pairs.push_back(pair);
      for (const int threads : {1, 3})
        EXPECT_EQ(
            findSelfIntersectionsOf(mesh.points, mesh.triangles, of, test::onThreads(threads)),
            expected_pairs)
            << size;
    }
  }
}

TEST(SelfIntersection, BadInputIsInvalidInputAndNothingHasNone) {
  EXPECT_TRUE(findSelfIntersections(Positions(3, 0), Triangles(3, 0)).empty());
  EXPECT_TRUE(findSelfIntersections(test::spiralSphere(9), Triangles(3, 0)).empty());
  Mesh mesh{Positions::Identity(3, 3), Triangles(3, 1)};
  mesh.triangles << 0, 1, 2;
  EXPECT_NO_THROW(pairsOf(mesh, 1024));
  for (const int threads : {-1, 1025}) {
    EXPECT_THROW(pairsOf(mesh, threads), InvalidInput);
    EXPECT_THROW(
        findSelfIntersectionsOf(mesh.points, mesh.triangles, {0}, test::onThreads(threads)),
        InvalidInput);
  }
  for (const Index triangle : {-1, 1})
    EXPECT_THROW(findSelfIntersectionsOf(mesh.points, mesh.triangles, {triangle}), InvalidInput);
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
  // More triangles than there are between reports.
  const Mesh mesh = inUnits(knottedTube(136), 1.0);
  ASSERT_GT(mesh.triangles.cols(), 131072);
  const std::vector<Index> some{0, 5, 100};
  for (const bool of_some : {false, true}) {
    const auto run = [&](const std::function<bool(double)>& progress) {
      const Execution options = test::reportingTo(progress);
      return of_some ? findSelfIntersectionsOf(mesh.points, mesh.triangles, some, options)
                     : findSelfIntersections(mesh.points, mesh.triangles, options);
    };
    Pairs watched;
    const std::vector<double> fractions =
        test::fractionsOf([&](const auto& progress) { watched = run(progress); });
    EXPECT_EQ(watched, run({}));
    EXPECT_TRUE(test::areFractions(fractions));
    EXPECT_EQ(fractions.back(), 1.0);
    // Two of each pass over all triangles.
    EXPECT_GE(fractions.size(), of_some ? 5U : 6U);
    for (const int last : {1, 3, static_cast<int>(fractions.size())}) {
      int count = 0;
      EXPECT_THROW(run([&](double) { return ++count < last; }), Cancelled);
      EXPECT_EQ(count, last);
    }
  }
}

}  // namespace
}  // namespace spherical_param
