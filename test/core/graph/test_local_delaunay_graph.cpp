#include "spherical_param/neighbor_graph.h"

#include "graph_building.h"
#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

namespace spherical_param {
namespace {

using test::bruteForceNeighbors;
using test::bruteForceSearch;
using test::horizontally;
using test::randomSphere;

using Edges = std::set<std::pair<Index, Index>>;

std::vector<Index> rowOf(const Graph& graph, Index i) {
  const auto row = static_cast<std::size_t>(i);
  return {graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[row]),
          graph.neighbors.begin() + static_cast<std::ptrdiff_t>(graph.offsets[row + 1])};
}

Edges edgesOf(const Graph& graph) {
  Edges edges;
  for (Index i = 0; i < static_cast<Index>(graph.size()); ++i)
    for (const Index j : rowOf(graph, i))
      edges.insert({i, j});
  return edges;
}

/// Nodes that can be reached from another node, itself included, without node `removed`.
Index countReachable(const Graph& graph, Index removed) {
  std::vector<bool> seen(graph.size(), false);
  if (removed >= 0)
    seen[static_cast<std::size_t>(removed)] = true;
  std::vector<Index> stack{removed == 0 ? 1 : 0};
  seen[static_cast<std::size_t>(stack[0])] = true;
  Index count = 0;
  while (!stack.empty()) {
    const Index i = stack.back();
    stack.pop_back();
    ++count;
    for (const Index j : rowOf(graph, i))
      if (!seen[static_cast<std::size_t>(j)]) {
        seen[static_cast<std::size_t>(j)] = true;
        stack.push_back(j);
      }
  }
  return count;
}

bool hasCutNode(const Graph& graph) {
  const auto n = static_cast<Index>(graph.size());
  for (Index i = 0; i < n; ++i)
    if (countReachable(graph, i) < n - 1)
      return true;
  return false;
}

/// What every graph must be, for four points and more.
void expectSound(const Positions& points, const NeighborGraph& result) {
  const Graph& graph = result.graph;
  ASSERT_EQ(static_cast<Index>(graph.size()), points.cols());
  ASSERT_EQ(graph.lengths.size(), graph.neighbors.size());
  const Edges edges = edgesOf(graph);
  for (Index i = 0; i < points.cols(); ++i) {
    const std::vector<Index> row = rowOf(graph, i);
    EXPECT_GE(row.size(), 3U);
    EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
    EXPECT_EQ(std::adjacent_find(row.begin(), row.end()), row.end());
    for (std::size_t k = 0; k < row.size(); ++k) {
      EXPECT_NE(row[k], i);
      EXPECT_EQ(edges.count({row[k], i}), 1U);
      const double length = (points.col(i) - points.col(row[k])).stableNorm();
      EXPECT_NEAR(graph.lengths[graph.offsets[static_cast<std::size_t>(i)] + k], length,
                  1e-15 * length);
    }
  }
  EXPECT_EQ(countReachable(graph, -1), points.cols());
}

/// All that a graph of local Delaunay neighbourhoods depends on.
struct Setting : Execution {
  StarAgreement agreement = StarAgreement::Both;
  NeighborSearch search;
};

NeighborGraph buildLocalDelaunayGraph(const Positions& points, const NeighborLists& lists,
                                      const Setting& setting = {}) {
  GraphOptions options;
  options.agreement = setting.agreement;
  return buildNeighborGraph(points, lists, options, setting.search, setting);
}

NeighborGraph build(const Positions& points, int k = 12, int threads = 0) {
  Setting options;
  options.threads = threads;
  options.search = bruteForceSearch(points);
  return buildLocalDelaunayGraph(points, bruteForceNeighbors(points, k), options);
}

struct Star {
  std::set<Index> nodes;
  double squared_radius = 0.0;  ///< of the cell; infinite if it is not bounded
};

/// Voronoi neighbours of point i among `candidates` in the plane of its ten nearest, from the
/// definition: on the bisector there is a piece that is nearer to no other site.
Star bruteForceStar(const Positions& points, Index i, const std::vector<Index>& candidates) {
  const NeighborLists nearest = bruteForceNeighbors(points, 10);
  Eigen::Matrix<double, 3, 10> offsets;
  for (int k = 0; k < 10; ++k)
    offsets.col(k) = points.col(nearest.indices[nearest.offsets[static_cast<std::size_t>(i)] +
                                                static_cast<std::size_t>(k)]) -
                     points.col(i);
  offsets.colwise() -= Eigen::Vector3d(offsets.rowwise().mean());
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(offsets * offsets.transpose()).eigenvectors();

  std::vector<std::pair<Index, Eigen::Vector2d>> sites;
  for (const Index j : candidates) {
    const Eigen::Vector3d offset = points.col(j) - points.col(i);
    const Eigen::Vector2d flat(axes.col(1).dot(offset), axes.col(2).dot(offset));
    if (std::abs(axes.col(0).dot(offset)) <= 0.85 * offset.norm())
      sites.emplace_back(j, flat.normalized() * offset.norm());
  }
  Star star;
  for (const auto& [j, site] : sites) {
    const Eigen::Vector2d along(-site.y(), site.x());
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    for (const auto& [k, other] : sites) {
      if (k == j)
        continue;
      // (site / 2 + t along) . other <= other^2 / 2
      const double slope = along.dot(other);
      const double bound = (0.5 * other.squaredNorm() - 0.5 * site.dot(other)) / slope;
      if (slope > 0.0)
        high = std::min(high, bound);
      else
        low = std::max(low, bound);
    }
    if (low >= high)
      continue;
    star.nodes.insert(j);
    for (const double t : {low, high})
      star.squared_radius = std::max(star.squared_radius, (0.25 + t * t) * site.squaredNorm());
  }
  return star;
}

/// Points of the plane with a spacing of 1, bent upwards.
Positions hexagonalPatch(int rows, double curvature) {
  Positions points(3, rows * rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column) {
      const double x = column + 0.5 * (row % 2);
      const double y = std::sqrt(0.75) * row;
      points.col(row * rows + column) << x, y, curvature * (x * x + y * y);
    }
  return points;
}

Positions jitteredSheet(int rows, double height, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  Positions points(3, rows * rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column)
      points.col(row * rows + column) << column + jitter(random), row + jitter(random), height;
  return points;
}

TEST(LocalDelaunayGraph, JoinsThePairsWhoseStarsAmongAllPointsAgree) {
  const Positions points = randomSphere(150, 1);
  std::vector<Star> stars;
  std::vector<Index> others;
  for (Index i = 0; i < points.cols(); ++i) {
    others.clear();
    for (Index j = 0; j < points.cols(); ++j)
      if (j != i)
        others.push_back(j);
    stars.push_back(bruteForceStar(points, i, others));
  }
  Edges expected;
  for (Index i = 0; i < points.cols(); ++i)
    for (const Index j : stars[static_cast<std::size_t>(i)].nodes)
      if (stars[static_cast<std::size_t>(j)].nodes.count(i) > 0)
        expected.insert({i, j});

  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_EQ(result.report.uncertified, 0);
  EXPECT_EQ(result.report.weak, 0);
  EXPECT_EQ(result.report.components, 1);
  EXPECT_TRUE(result.report.bridges.empty());
  EXPECT_TRUE(result.report.without_tangent_plane.empty());
  EXPECT_EQ(edgesOf(result.graph), expected);
}

TEST(LocalDelaunayGraph, OneStarIsEnoughIfAskedFor) {
  const Positions points = randomSphere(150, 1);
  std::vector<Index> others;
  Edges either;
  Edges both;
  for (Index i = 0; i < points.cols(); ++i) {
    others.clear();
    for (Index j = 0; j < points.cols(); ++j)
      if (j != i)
        others.push_back(j);
    for (const Index j : bruteForceStar(points, i, others).nodes) {
      if (either.count({i, j}) > 0)
        both.insert({std::pair(i, j), std::pair(j, i)});
      either.insert({std::pair(i, j), std::pair(j, i)});
    }
  }
  ASSERT_GT(either.size(), both.size());
  Setting options;
  options.search = bruteForceSearch(points);
  const NeighborLists lists = bruteForceNeighbors(points, 12);
  EXPECT_EQ(edgesOf(buildLocalDelaunayGraph(points, lists, options).graph), both);
  options.agreement = StarAgreement::Either;
  const NeighborGraph result = buildLocalDelaunayGraph(points, lists, options);
  expectSound(points, result);
  EXPECT_EQ(edgesOf(result.graph), either);
  EXPECT_EQ(result.report.weak, 0);
}

TEST(LocalDelaunayGraph, OneStarGivesAllThatTwoGive) {
  // Of clouds with and without tangent planes, creases, and parts.
  Positions away = randomSphere(60, 3);
  away.colwise() += Eigen::Vector3d(10.0, 0.0, 0.0);
  for (const Positions& points :
       {jitteredSheet(12, 0.0, 2), test::cubeGrid(6), horizontally(randomSphere(80, 2), away),
        horizontally(jitteredSheet(8, 0.0, 4), jitteredSheet(8, 0.7, 5)), randomSphere(5, 6)}) {
    Setting options;
    options.search = bruteForceSearch(points);
    const NeighborLists lists = bruteForceNeighbors(points, 12);
    const NeighborGraph both = buildLocalDelaunayGraph(points, lists, options);
    options.agreement = StarAgreement::Either;
    options.threads = 1;
    const NeighborGraph either = buildLocalDelaunayGraph(points, lists, options);
    expectSound(points, either);
    EXPECT_LE(either.report.weak, both.report.weak);
    EXPECT_LE(either.report.components, both.report.components);
    EXPECT_GE(either.graph.edgeCount() + both.report.bridges.size(), both.graph.edgeCount());
    options.threads = 3;
    const NeighborGraph again = buildLocalDelaunayGraph(points, lists, options);
    EXPECT_EQ(again.graph.neighbors, either.graph.neighbors);
    EXPECT_EQ(again.graph.lengths, either.graph.lengths);
  }
}

TEST(LocalDelaunayGraph, SearchIsAskedOnceARoundForThePointsThatAreNotCertified) {
  const Positions points = randomSphere(150, 2);
  const auto uncertified = [&](int k) {
    const NeighborLists lists = bruteForceNeighbors(points, k);
    std::vector<Index> result;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      const std::vector<Index> list(
          lists.indices.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i]),
          lists.indices.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i + 1]));
      const auto point = static_cast<Index>(i);
      const double squared_reach = (points.col(list.back()) - points.col(point)).squaredNorm();
      if (4.0 * bruteForceStar(points, point, list).squared_radius > squared_reach)
        result.push_back(point);
    }
    return result;
  };
  std::vector<std::pair<std::vector<Index>, int>> asked;
  Setting options;
  options.search = [&](const std::vector<Index>& some, int count) {
    asked.emplace_back(some, count);
    return bruteForceSearch(points)(some, count);
  };
  const NeighborGraph result =
      buildLocalDelaunayGraph(points, bruteForceNeighbors(points, 12), options);
  const std::vector<Index> first = uncertified(12);
  const std::vector<Index> second = uncertified(24);
  ASSERT_FALSE(first.empty());
  ASSERT_GE(asked.size(), 1U);
  EXPECT_EQ(asked[0].first, first);
  EXPECT_EQ(asked[0].second, 24);
  EXPECT_EQ(result.report.searched_again, static_cast<Index>(first.size()));
  ASSERT_EQ(asked.size(), second.empty() ? 1U : 2U);
  if (!second.empty()) {
    EXPECT_EQ(asked[1].first, second);
    EXPECT_EQ(asked[1].second, 32);
  }
  EXPECT_EQ(result.report.uncertified, static_cast<Index>(uncertified(32).size()));
}

TEST(LocalDelaunayGraph, WithoutASearchTheListsAreAllThereIs) {
  const Positions points = randomSphere(300, 3);
  const NeighborGraph result = buildLocalDelaunayGraph(points, bruteForceNeighbors(points, 12));
  expectSound(points, result);
  EXPECT_EQ(result.report.searched_again, 0);
  EXPECT_GT(result.report.uncertified, 0);
}

TEST(LocalDelaunayGraph, TheSearchMakesUpForListsThatAreShortOrEmpty) {
  const Positions points = randomSphere(300, 4);
  const Edges expected = edgesOf(build(points, 32).graph);
  EXPECT_EQ(edgesOf(build(points, 12).graph), expected);
  EXPECT_EQ(edgesOf(build(points, 5).graph), expected);
  EXPECT_EQ(edgesOf(build(points, 0).graph), expected);
}

TEST(LocalDelaunayGraph, ListsMayBeUnsortedAndHoldThePointAndRepetitions) {
  const Positions points = randomSphere(200, 5);
  NeighborLists lists = bruteForceNeighbors(points, 12);
  NeighborLists messy;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    for (std::size_t e = lists.offsets[i + 1]; e > lists.offsets[i]; --e)
      messy.indices.push_back(lists.indices[e - 1]);
    messy.indices.push_back(static_cast<Index>(i));
    messy.indices.push_back(lists.indices[lists.offsets[i]]);
    messy.offsets.push_back(messy.indices.size());
  }
  EXPECT_EQ(edgesOf(buildLocalDelaunayGraph(points, messy).graph),
            edgesOf(buildLocalDelaunayGraph(points, lists).graph));
}

TEST(LocalDelaunayGraph, RegularSolidsHaveTheirOwnEdges) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  Positions tetrahedron(3, 4);
  tetrahedron << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1;
  Positions octahedron(3, 6);
  octahedron << 1, -1, 0, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 1, -1;
  Positions icosahedron(3, 12);
  icosahedron << 0, 0, 0, 0, 1, 1, -1, -1, g, g, -g, -g,  //
      1, 1, -1, -1, g, -g, g, -g, 0, 0, 0, 0,             //
      g, -g, g, -g, 0, 0, 0, 0, 1, -1, 1, -1;
  struct Solid {
    Positions points;
    double edge;
    std::size_t edges;
  };
  for (const Solid& solid :
       {Solid{tetrahedron, std::sqrt(8.0), 6}, Solid{octahedron, std::sqrt(2.0), 12},
        Solid{test::cubeGrid(2), 1.0, 12}, Solid{icosahedron, 2.0, 30}}) {
    const NeighborGraph result = build(solid.points);
    expectSound(solid.points, result);
    EXPECT_EQ(result.graph.edgeCount(), solid.edges);
    for (const double length : result.graph.lengths)
      EXPECT_NEAR(length, solid.edge, 1e-12);
  }
}

TEST(LocalDelaunayGraph, InAHexagonalPatchThePointsInsideHaveTheirSixNeighbours) {
  const int rows = 14;
  const Positions points = hexagonalPatch(rows, 0.002);
  const NeighborGraph result = build(points);
  expectSound(points, result);
  for (int row = 1; row + 1 < rows; ++row)
    for (int column = 1; column + 1 < rows; ++column) {
      const Index i = row * rows + column;
      const Index side = row % 2;
      EXPECT_EQ(rowOf(result.graph, i),
                (std::vector<Index>{i - rows - 1 + side, i - rows + side, i - 1, i + 1,
                                    i + rows - 1 + side, i + rows + side}));
    }
}

TEST(LocalDelaunayGraph, SquaresHaveNoDiagonals) {
  const int rows = 12;
  Positions points(3, rows * rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column)
      points.col(row * rows + column) << 0.1 * column, 0.1 * row, 0.3;
  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_TRUE(result.report.without_tangent_plane.empty());
  for (int row = 1; row + 1 < rows; ++row)
    for (int column = 1; column + 1 < rows; ++column) {
      const Index i = row * rows + column;
      // Corners have two neighbours and are repaired, beyond the squares that they are part of.
      if ((row > 2 && row + 3 < rows) || (column > 2 && column + 3 < rows)) {
        EXPECT_EQ(rowOf(result.graph, i), (std::vector<Index>{i - rows, i - 1, i + 1, i + rows}));
      }
    }
}

TEST(LocalDelaunayGraph, SheetsThatAreCloseToEachOtherAreNotJoinedInside) {
  const int rows = 20;
  const Positions points = horizontally(jitteredSheet(rows, 0.0, 6), jitteredSheet(rows, 1.5, 7));
  const NeighborGraph result = build(points);
  expectSound(points, result);
  for (const auto& [i, j] : edgesOf(result.graph)) {
    const bool inside = std::min(i / rows, i % rows) > 2 && std::max(i / rows, i % rows) < rows - 3;
    EXPECT_FALSE(inside && i < rows * rows && j >= rows * rows) << i << " " << j;
  }
}

TEST(LocalDelaunayGraph, BridgesAreTheClosestPairsWithDifferentEnds) {
  const Positions left = randomSphere(60, 8);
  Positions right = randomSphere(60, 9);
  right.row(0).array() += 10.0;
  const Positions points = horizontally(left, right);
  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_EQ(result.report.components, 2);
  ASSERT_EQ(result.report.bridges.size(), 3U);
  std::set<Index> taken;
  for (const Bridge& bridge : result.report.bridges) {
    double shortest = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < 60; ++i)
      for (Index j = 60; j < 120; ++j)
        if (taken.count(i) == 0 && taken.count(j) == 0)
          shortest = std::min(shortest, (points.col(i) - points.col(j)).norm());
    EXPECT_DOUBLE_EQ(bridge.length, shortest);
    taken.insert({bridge.from, bridge.to});
  }
}

TEST(LocalDelaunayGraph, PointsOnALineHaveNoTangentPlane) {
  Positions points(3, 100);
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) = Eigen::Vector3d(1.0, 2.0, 3.0) * (0.01 * i);
  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_EQ(static_cast<Index>(result.report.without_tangent_plane.size()), points.cols());
  EXPECT_EQ(result.report.uncertified, 0);
}

TEST(LocalDelaunayGraph, OnScanLinesTheNextLineIsFound) {
  // Ten times denser along the lines than across: the ten nearest are all on one line.
  Positions points(3, 30 * 12);
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> jitter(-0.01, 0.01);
  for (int line = 0; line < 12; ++line)
    for (int k = 0; k < 30; ++k)
      points.col(line * 30 + k) << 0.1 * k + jitter(random), line + jitter(random), 0.0;
  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_EQ(result.report.components, 1);
  EXPECT_TRUE(result.report.bridges.empty());
  std::vector<bool> has_plane(static_cast<std::size_t>(points.cols()), true);
  for (const Index i : result.report.without_tangent_plane)
    has_plane[static_cast<std::size_t>(i)] = false;
  for (int line = 1; line < 11; ++line)
    EXPECT_TRUE(has_plane[static_cast<std::size_t>(line * 30 + 15)]);
}

TEST(LocalDelaunayGraph, TinyCloudsHaveNoTangentPlanes) {
  for (Index n = 4; n <= 16; ++n)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Positions points = randomSphere(n, seed);
      const NeighborGraph result = build(points);
      expectSound(points, result);
      if (n <= 10) {
        EXPECT_EQ(static_cast<Index>(result.report.without_tangent_plane.size()), n);
      }
    }
  EXPECT_EQ(edgesOf(build(randomSphere(4, 1)).graph).size(), 12U);
}

TEST(LocalDelaunayGraph, TinyCloudsHaveTheGabrielGraph) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Positions points = randomSphere(9, seed);
    Edges expected;
    for (Index i = 0; i < 9; ++i)
      for (Index j = 0; j < 9; ++j) {
        const Eigen::Vector3d center = 0.5 * (points.col(i) + points.col(j));
        const double radius = 0.5 * (points.col(i) - points.col(j)).norm();
        bool empty = i != j;
        for (Index k = 0; k < 9; ++k)
          empty = empty && (k == i || k == j || (points.col(k) - center).norm() > radius);
        if (empty)
          expected.insert({i, j});
      }
    const NeighborGraph result = build(points);
    if (result.report.weak > 0)
      continue;
    EXPECT_EQ(edgesOf(result.graph), expected);
    ++compared;
  }
  EXPECT_GT(compared, 3);
}

TEST(LocalDelaunayGraph, AwkwardCloudsGiveSoundGraphs) {
  std::vector<Positions> clouds{test::cubeGrid(3), test::cubeGrid(7), test::spiralSphere(500)};
  // A cluster so small that the squares of its distances are near the least there are.
  Positions cluster = 1e-150 * randomSphere(40, 12);
  clouds.push_back(horizontally(randomSphere(60, 13), cluster));
  cluster *= 1e-100;  // their squares are zero
  clouds.push_back(horizontally(randomSphere(60, 13), cluster));
  Positions plate = randomSphere(400, 15);
  plate.row(2) *= 1e-4;
  clouds.push_back(plate);
  for (const Positions& points : clouds) {
    const NeighborGraph result = build(points);
    expectSound(points, result);
    EXPECT_FALSE(hasCutNode(result.graph)) << points.cols();
  }
}

TEST(LocalDelaunayGraph, NeedlesGiveSoundGraphs) {
  for (const double width : {0.1, 1e-2, 1e-3, 1e-8}) {
    Positions needle = randomSphere(200, 14);
    needle.topRows(2) *= width;
    expectSound(needle, build(needle));
  }
}

TEST(LocalDelaunayGraph, ListsOfTwoAndOfNoneGiveSoundGraphs) {
  const Positions points = randomSphere(80, 16);
  for (const int k : {0, 1, 2, 3})
    expectSound(points, buildLocalDelaunayGraph(points, bruteForceNeighbors(points, k)));
}

TEST(LocalDelaunayGraph, FewerThanFourPointsAreAllJoined) {
  for (const Index n : {0, 1, 2, 3}) {
    const Positions points = randomSphere(n, 17);
    const NeighborGraph result = build(points);
    EXPECT_EQ(static_cast<Index>(result.graph.size()), n);
    EXPECT_EQ(static_cast<Index>(result.graph.neighbors.size()), n * (n - (n > 0 ? 1 : 0)));
  }
}

TEST(LocalDelaunayGraph, NoNodeAloneJoinsTwoParts) {
  // Two patches and one point between them.
  const Positions patch = jitteredSheet(8, 0.0, 18);
  Positions other = patch;
  other.row(0).array() += 12.0;
  Positions middle(3, 1);
  middle << 9.5, 3.5, 0.0;
  const Positions points = horizontally(horizontally(patch, middle), other);
  const NeighborGraph result = build(points);
  expectSound(points, result);
  EXPECT_FALSE(hasCutNode(result.graph));
}

TEST(LocalDelaunayGraph, DanglingPartsAreFoundInAnyGraph) {
  std::mt19937_64 random(19);
  int dangling = 0;
  for (int round = 0; round < 300; ++round) {
    const Index n = 5 + round % 12;
    const Positions points = randomSphere(n, static_cast<std::uint64_t>(round));
    // A random tree and some more edges.
    std::vector<Bridge> edges;
    for (Index i = 1; i < n; ++i)
      edges.push_back({static_cast<Index>(random() % static_cast<std::uint64_t>(i)), i, 1.0});
    for (int extra = 0; extra < round % 14; ++extra) {
      const auto i = static_cast<Index>(random() % static_cast<std::uint64_t>(n));
      const auto j = static_cast<Index>(random() % static_cast<std::uint64_t>(n));
      if (i != j)
        edges.push_back({std::min(i, j), std::max(i, j), 1.0});
    }
    Graph graph;
    graph.offsets.assign(static_cast<std::size_t>(n) + 1, 0);
    graph = internal::withEdges(graph, edges);
    ASSERT_EQ(countReachable(graph, -1), n);
    const bool had_cut_node = hasCutNode(graph);
    EXPECT_EQ(internal::danglingBridges(points, graph, 2).empty(), !had_cut_node);
    dangling += had_cut_node ? 1 : 0;
    for (Index k = 0; k < n; ++k)
      graph = internal::withEdges(graph, internal::danglingBridges(points, graph, 2));
    EXPECT_FALSE(hasCutNode(graph));
  }
  EXPECT_GT(dangling, 50);
  EXPECT_LT(dangling, 280);
}

TEST(LocalDelaunayGraph, ScalingByAPowerOfTwoChangesNothing) {
  const Positions points = randomSphere(200, 20);
  const NeighborGraph expected = build(points);
  for (const int exponent : {-480, -400, -3, 5, 400}) {
    const NeighborGraph result = build(std::ldexp(1.0, exponent) * points);
    EXPECT_EQ(result.graph.offsets, expected.graph.offsets);
    EXPECT_EQ(result.graph.neighbors, expected.graph.neighbors);
    for (std::size_t e = 0; e < expected.graph.lengths.size(); ++e)
      EXPECT_DOUBLE_EQ(result.graph.lengths[e], std::ldexp(expected.graph.lengths[e], exponent));
  }
}

TEST(LocalDelaunayGraph, RotatedAndShiftedPointsHaveTheSameGraph) {
  const Positions points = randomSphere(300, 21);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  Positions moved = rotation * points;
  moved.colwise() += Eigen::Vector3d(0.3, -0.2, 0.7);
  EXPECT_EQ(edgesOf(build(moved).graph), edgesOf(build(points).graph));
}

TEST(LocalDelaunayGraph, PermutedPointsHaveTheSameGraph) {
  const Positions points = randomSphere(300, 22);
  std::vector<Index> place(300);
  std::iota(place.begin(), place.end(), Index{0});
  std::mt19937_64 random(23);
  std::shuffle(place.begin(), place.end(), random);
  Positions permuted(3, 300);
  for (Index i = 0; i < 300; ++i)
    permuted.col(place[static_cast<std::size_t>(i)]) = points.col(i);
  Edges expected;
  for (const auto& [i, j] : edgesOf(build(points).graph))
    expected.insert({place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(j)]});
  EXPECT_EQ(edgesOf(build(permuted).graph), expected);
}

TEST(LocalDelaunayGraph, AnyNumberOfThreadsGivesTheSameBits) {
  const Positions points = randomSphere(6000, 24);
  const NeighborLists lists = bruteForceNeighbors(points, 12);
  Setting options;
  options.threads = 1;
  const NeighborGraph expected = buildLocalDelaunayGraph(points, lists, options);
  EXPECT_EQ(countReachable(expected.graph, -1), points.cols());
  for (const int threads : {2, 3, 0}) {
    options.threads = threads;
    const NeighborGraph result = buildLocalDelaunayGraph(points, lists, options);
    EXPECT_EQ(result.graph.offsets, expected.graph.offsets);
    EXPECT_EQ(result.graph.neighbors, expected.graph.neighbors);
    EXPECT_EQ(result.graph.lengths, expected.graph.lengths);
    EXPECT_EQ(result.report.uncertified, expected.report.uncertified);
    EXPECT_EQ(result.report.weak, expected.report.weak);
  }
}

TEST(LocalDelaunayGraph, AnswersOfTheSearchAreChecked) {
  const Positions points = randomSphere(50, 25);
  Setting options;
  options.search = [](const std::vector<Index>&, int) { return NeighborLists(); };
  const NeighborLists lists = bruteForceNeighbors(points, 4);
  EXPECT_THROW(buildLocalDelaunayGraph(points, lists, options), InvalidInput);
  options.search = [](const std::vector<Index>& some, int) {
    NeighborLists answer;
    answer.offsets.assign(some.size() + 1, 0);
    answer.offsets.back() = 1;
    answer.indices = {50};
    return answer;
  };
  EXPECT_THROW(buildLocalDelaunayGraph(points, lists, options), InvalidInput);
  // Fewer than there were before: all that is known is kept.
  options.search = [](const std::vector<Index>& some, int) {
    NeighborLists answer;
    answer.offsets.assign(some.size() + 1, 0);
    return answer;
  };
  EXPECT_EQ(edgesOf(buildLocalDelaunayGraph(points, lists, options).graph),
            edgesOf(buildLocalDelaunayGraph(points, lists).graph));
}

TEST(LocalDelaunayGraph, BadInputIsInvalidInput) {
  const Positions points = randomSphere(30, 26);
  const NeighborLists good = bruteForceNeighbors(points, 12);
  NeighborLists bad = good;
  bad.indices[3] = 30;
  EXPECT_THROW(buildLocalDelaunayGraph(points, bad), InvalidInput);
  bad = good;
  bad.offsets.pop_back();
  EXPECT_THROW(buildLocalDelaunayGraph(points, bad), InvalidInput);
  const auto refused = [&](const auto& change) {
    Setting options;
    change(options);
    EXPECT_THROW(buildLocalDelaunayGraph(points, good, options), InvalidInput);
    EXPECT_THROW(buildLocalDelaunayGraph(Positions(3, 0), {}, options), InvalidInput);
  };
  refused([](Setting& options) { options.threads = -1; });
  refused([](Setting& options) { options.threads = 1025; });
}

TEST(LocalDelaunayGraph, ProgressIsReportedAndCancels) {
  const Positions points = test::spiralSphere(300000);
  const NeighborLists lists = test::spiralNeighbors(points, 12);
  const auto run = [&](const std::function<bool(double)>& progress) {
    Setting options;
    options.progress = test::reportingTo(progress).progress;
    return buildLocalDelaunayGraph(points, lists, options);
  };
  const std::vector<double> fractions = test::fractionsOf(run);
  EXPECT_TRUE(test::areFractions(fractions));
  EXPECT_GE(fractions.size(), 10U);
  EXPECT_EQ(run({}).graph.neighbors, run([](double) { return true; }).graph.neighbors);
  for (const int last : {1, 4, static_cast<int>(fractions.size())}) {
    int count = 0;
    EXPECT_THROW(run([&](double) { return ++count < last; }), Cancelled);
    EXPECT_EQ(count, last);
  }
}

}  // namespace
}  // namespace spherical_param
