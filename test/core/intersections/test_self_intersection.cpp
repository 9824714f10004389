#include "spherical_param/self_intersection.h"

#include "intersecting_pairs.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

using Pairs = std::vector<std::array<Index, 2>>;

Pairs pairsOf(const Mesh& mesh) {
  return findSelfIntersections(mesh.points, mesh.triangles, Execution{1});
}

// --- An oracle: all pairs, separating axes in integers -------------------------------------------

__extension__ using Wide = __int128;
using Whole = Eigen::Matrix<Wide, 3, 1>;  ///< points below 2^30, and cross products of these

Whole normalOf(const std::vector<Whole>& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]);
}

/// Whether the convex hulls of two sets of points, segments or triangles with area, are disjoint:
/// then one of the normals of the facets of their Minkowski difference separates them (S.
/// Gottschalk, M. Lin and D. Manocha, "OBBTree", 1996). The coordinate axes find most of them.
bool apart(const std::vector<Whole>& a, const std::vector<Whole>& b) {
  const auto separates = [&](const Whole& axis) {
    const auto order = [&](const Whole& p, const Whole& q) { return axis.dot(p) < axis.dot(q); };
    const auto [a_low, a_high] = std::minmax_element(a.begin(), a.end(), order);
    const auto [b_low, b_high] = std::minmax_element(b.begin(), b.end(), order);
    return order(*a_high, *b_low) || order(*b_high, *a_low);
  };
  if (separates({1, 0, 0}) || separates({0, 1, 0}) || separates({0, 0, 1}))
    return true;
  std::vector<Whole> sides;
  std::vector<Whole> axes;
  for (const auto* hull : {&a, &b}) {
    for (std::size_t i = 0; i < hull->size(); ++i)
      sides.emplace_back((*hull)[(i + 1) % hull->size()] - (*hull)[i]);
    if (hull->size() == 3)
      axes.push_back(normalOf(*hull));
  }
  std::vector<Whole> others = axes;
  others.insert(others.end(), sides.begin(), sides.end());
  for (const Whole& side : sides)
    for (const Whole& other : others)
      axes.push_back(side.cross(other));
  return std::any_of(axes.begin(), axes.end(), separates);
}

bool intersect(const std::vector<Whole>& a, const std::vector<Whole>& b) {
  const Whole zero = Whole::Zero();
  if (normalOf(a) == zero || normalOf(b) == zero)
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
    const Whole normal_a = normalOf({common[0], common[1], only_a[0]});
    const Whole normal_b = normalOf({common[0], common[1], only_b[0]});
    return normal_a.cross(normal_b) == zero && normal_a.dot(normal_b) > 0;
  }
  default:
    return true;
  }
}

/// Of a mesh whose coordinates are integers.
Pairs bruteForce(const Mesh& mesh) {
  std::vector<std::vector<Whole>> triangles;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    triangles.emplace_back();
    for (const Index v : mesh.triangles.col(t))
      triangles.back().emplace_back(mesh.points.col(v).cast<Wide>());
  }
  Pairs pairs;
  for (std::size_t s = 0; s < triangles.size(); ++s)
    for (std::size_t t = s + 1; t < triangles.size(); ++t)
      if (intersect(triangles[s], triangles[t]))
        pairs.push_back({static_cast<Index>(s), static_cast<Index>(t)});
  return pairs;
}

Positions wholePoints(std::mt19937_64& random, Index count, std::int64_t most) {
  std::uniform_int_distribution<std::int64_t> coordinate(0, most);
  return Positions::NullaryExpr(3, count, [&] { return static_cast<double>(coordinate(random)); });
}

TEST(SelfIntersection, PairsAreThoseOfIntegerArithmetic) {
  std::mt19937_64 random(1);
  std::size_t count = 0;
  for (int round = 0; round < 1000; ++round) {
    SCOPED_TRACE(round);
    // Triangles over common points of a grid: full of ties of every kind.
    const std::int64_t steps =
        std::array<std::int64_t, 6>{1, 2, 4, 8, 50, 1 << 29}[static_cast<std::size_t>(round) % 6];
    const Index n = 6 + round % 9;
    Mesh mesh{wholePoints(random, n, steps), Triangles(3, 18)};
    if (round % 7 < 2 && steps < 100)  // in the plane x + 2 y - 3 z = 0, but for one point in some
      mesh.points.row(0).tail(n - round % 2) =
          (3.0 * mesh.points.row(2) - 2.0 * mesh.points.row(1)).tail(n - round % 2);
    for (Index& v : mesh.triangles.reshaped())
      v = std::uniform_int_distribution<Index>(0, n - 1)(random);
    auto half = mesh.points.leftCols(n / 2);
    half = (half.array() == 0.0).select(-half, half);  // -0 is 0
    const Pairs pairs = bruteForce(mesh);
    count += pairs.size();
    ASSERT_EQ(pairsOf(mesh), pairs);
    if (round % 99 != 98)
      continue;
    for (const double unit : {0x1p-1060, 0x1p-300, 0x1p-3, 0x1p40, 0x1p300, 0x1p990})
      ASSERT_EQ(pairsOf({unit * mesh.points, mesh.triangles}), pairs) << unit;
  }
  EXPECT_GT(count, 10000U);
  EXPECT_TRUE(pairsOf({Positions(3, 0), Triangles(3, 0)}).empty());
  EXPECT_TRUE(pairsOf({spiralSphere(9), Triangles(3, 0)}).empty());
}

/// Small triangles in a cube, some of which form a cluster; some as large as all.
Mesh unevenSoup(std::uint64_t seed, Index small, Index crowded, Index large) {
  std::mt19937_64 random(seed);
  constexpr std::int64_t extent = 1 << 29;
  const Index n = small + crowded + large;
  Mesh mesh{Positions(3, 3 * n), Triangles(3, n)};
  for (Index t = 0; t < n; ++t) {
    // Where a triangle is, at most, and how large.
    const auto [place, size] = t < small ? std::pair(extent, extent / 8)
                               : t < small + crowded
                                   ? std::pair(std::int64_t{200}, std::int64_t{40})
                                   : std::pair(std::int64_t{0}, extent);
    const Eigen::Vector3d at = wholePoints(random, 1, place);
    mesh.points.middleCols(3 * t, 3) = wholePoints(random, 3, size).colwise() + at;
    mesh.triangles.col(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  }
  // The tree gains nothing from the order.
  mesh.triangles = mesh.triangles(Eigen::all, shuffledRange(n, seed)).eval();
  return mesh;
}

/// A tube whose ends run into each other, on a grid of 2^-20, in units of that.
Mesh knottedTube(int ring) {
  Mesh tube = bentTube(20.0, 2.2 * kPi, ring);
  tube.points = (0x1p20 * tube.points).array().round();
  return tube;
}

/// Number of octants around the centre in which triangles of the pairs begin.
std::size_t octantsOf(const Pairs& pairs, const Mesh& mesh) {
  const Eigen::Vector3d center = mesh.points.rowwise().mean();
  std::set<std::vector<bool>> octants;
  for (const auto& pair : pairs) {
    const Eigen::Vector3d p = mesh.points.col(mesh.triangles(0, pair[0])) - center;
    octants.insert({p.x() < 0.0, p.y() < 0.0, p.z() < 0.0});
  }
  return octants.size();
}

IntersectingPairs foundIn(const Mesh& mesh, std::size_t most, int threads = 1) {
  return findPairsUpTo(most, mesh.points, mesh.triangles, Execution{threads});
}

TEST(SelfIntersection, ASearchUpToANumberEndsWithASpreadSample) {
  for (const Index small : {6000, 140000}) {
    const Mesh mesh = unevenSoup(3, small, 0, 0);
    const Pairs all = pairsOf(mesh);
    const IntersectingPairs sample = foundIn(mesh, 200);
    EXPECT_TRUE(sample.is_sample);
    EXPECT_EQ(sample.pairs, foundIn(mesh, 200, 3).pairs);
    EXPECT_GT(countTriangles(sample.pairs), 200U);
    EXPECT_LT(sample.pairs.size(), all.size());
    EXPECT_EQ(octantsOf(sample.pairs, mesh), 8U);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), sample.pairs.begin(), sample.pairs.end()));
  }
  const Mesh mesh = unevenSoup(3, 30000, 3000, 4);
  const Pairs all = pairsOf(mesh);
  const std::size_t count = countTriangles(all);
  ASSERT_GT(count, 5000U);
  EXPECT_EQ(foundIn(mesh, count).pairs, all);
  EXPECT_FALSE(foundIn(mesh, count).is_sample);
  // Fewer pairs are better, but a sample never is.
  EXPECT_FALSE(foundIn(mesh, 200).areFewerThan(foundIn(mesh, count)));
  EXPECT_TRUE(foundIn(mesh, count).areFewerThan(foundIn(mesh, 200)));
}

TEST(SelfIntersection, PairsOfLargeMeshesAndOfSetsOfTrianglesAreThoseOfIntegerArithmetic) {
  std::mt19937_64 random(7);
  for (const Mesh& mesh : {unevenSoup(3, 200, 300, 8), knottedTube(14)}) {
    const Pairs pairs = bruteForce(mesh);
    EXPECT_EQ(pairsOf(mesh), pairs);
    EXPECT_GT(pairs.size(), 50U);
    const auto m = static_cast<Index>(mesh.triangles.cols());
    for (const Index size : {0, 1, 60, 400, m}) {
      std::vector<Index> of(static_cast<std::size_t>(size));
      for (Index& t : of)
        t = std::uniform_int_distribution<Index>(0, m - 1)(random);
      const std::set<Index> set(of.begin(), of.end());
      Pairs expected;
      for (const auto& [s, t] : pairs)
        if (set.count(s) + set.count(t) > 0)
          expected.push_back({s, t});
      EXPECT_EQ(findSelfIntersectionsOf(mesh.points, mesh.triangles, of), expected);
    }
  }
}

}  // namespace
}  // namespace spherical_param::test
