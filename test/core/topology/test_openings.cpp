#include "graph_building.h"
#include "graphs.h"
#include "open_shapes.h"

namespace spherical_param::test {
namespace {

std::vector<Opening> openingsOf(const Positions& points) {
  return test::openingsOf(points, graphOf(points, bruteForceNeighbors(points, 24)).graph).openings;
}

TEST(Openings, AreNoneOfClosedSurfacesHoweverTheyAreSampled) {
  for (const Positions& points : {spiralSphere(1500), randomSphere(1500, 1), cubeGrid(14)})
    EXPECT_TRUE(openingsOf(points).empty());
}

TEST(Openings, HaveTheSizesOfTheHole) {
  const std::vector<Opening> openings = openingsOf(tube(20, 40));
  ASSERT_EQ(openings.size(), 2U);
  for (const Opening& opening : openings) {
    EXPECT_EQ(opening.loop.size(), 40U);
    EXPECT_NEAR(opening.boundary_length, 2.0 * kPi, 0.01);
    EXPECT_NEAR(opening.area, kPi, 0.02);
    EXPECT_NEAR(opening.width, 2.0, 0.02);
    EXPECT_NEAR(opening.spacing, 2.0 * kPi / 40, 0.03);
    EXPECT_LT(opening.center.head<2>().norm(), 1e-9);
    EXPECT_EQ(opening.certainty, 1.0);
    EXPECT_TRUE(opening.is_flat);
    EXPECT_FALSE(opening.is_filled);
  }
  EXPECT_FALSE(openingsOf(sphereWithHoles(2000, 1, 0.5)).front().is_flat);
}

TEST(Openings, AreABaseIfAllOfTheSurfaceIsOnOneSide) {
  const auto is_base = [](double height) {
    const Positions above =
        pointsWhere(spiralSphere(2000), [=](const auto& p) { return p.z() > height; });
    return openingsOf(above).front().is_base;
  };
  EXPECT_TRUE(is_base(-0.9));
  EXPECT_TRUE(is_base(0.0));
  // Another sphere hangs lower.
  const Positions lower = spiralSphere(1000).colwise() + Eigen::Vector3d(2.5, 0.0, -1.5);
  const Positions above =
      pointsWhere(spiralSphere(2000), [](const auto& p) { return p.z() > -0.9; });
  EXPECT_FALSE(openingsOf(horizontally(above, lower)).front().is_base);
}

/// Points of a hexagonal grid of distance 1, in 20 rows, that are kept.
Positions hexagonalGrid(Index columns, const std::function<bool(Index)>& is_kept) {
  std::vector<Eigen::Vector3d> points;
  for (Index i = 0; i < 20 * columns; ++i)
    if (is_kept(i))
      points.emplace_back(i % columns + 0.5 * (i / columns % 2), std::sqrt(0.75) * (i / columns),
                          0.0);
  return positionsOf(points);
}

TEST(Openings, TheBoundaryOfALowSheetIsCertainHoweverFewItsPoints) {
  const auto dome = [](double height) {
    Positions points = hexagonalGrid(6, [](Index i) { return i < 36; });
    const Eigen::Vector3d center = points.rowwise().mean();
    points.row(2) = -height * (points.colwise() - center).colwise().squaredNorm();
    return openingsOf(points);
  };
  ASSERT_FALSE(dome(0.02).empty());
  EXPECT_TRUE(dome(0.02).front().isCertain());
  for (const Opening& opening : dome(0.3))
    EXPECT_FALSE(opening.isCertain());
}

TEST(Openings, ThatCurlAreAsWideAsTheLeastSurfaceOverThem) {
  // Half of a tennis ball: the vector area of its boundary is 0.
  const Positions half = pointsWhere(spiralSphere(4000), [](const Eigen::Vector3d& p) {
    return p.x() * p.x() - p.y() * p.y() + 0.3 * p.z() > 0.0;
  });
  const std::vector<Opening> openings = openingsOf(half);
  ASSERT_EQ(openings.size(), 1U);
  // The cone from the middle of the ball to the boundary is at least as large.
  EXPECT_GT(openings[0].area, 2.0);
  EXPECT_LE(openings[0].area, openings[0].boundary_length / 2.0);
  EXPECT_NEAR(openings[0].width, 4.0 * openings[0].area / openings[0].boundary_length, 1e-12);
  EXPECT_TRUE(openings[0].isCertain());
}

TEST(Openings, EdgesAcrossThemAreFalse) {
  const Positions points = sphereWithHoles(1500, 1, 0.4);
  const Graph graph = graphOf(points, bruteForceNeighbors(points, 24)).graph;
  const std::vector<Opening> openings = test::openingsOf(points, graph).openings;
  ASSERT_EQ(openings.size(), 1U);
  const std::vector<Index>& loop = openings[0].loop;
  const auto [v, w] = std::minmax(loop[0], loop[loop.size() / 2]);
  const double length = (points.col(v) - points.col(w)).norm();
  const Openings crossed = test::openingsOf(points, withEdges(graph, {{v, w, length}}));
  ASSERT_EQ(crossed.openings.size(), 1U);
  const std::array<Index, 2> edge{v, w};
  EXPECT_EQ(std::count(crossed.false_edges.begin(), crossed.false_edges.end(), edge), 1);
}

TEST(Openings, CountFromThreeSpacingsOn) {
  // Without five points in two rows the hole is of 19 triangles and 11 edges, a little less than 3
  // wide: 4 area / length = 2.99. Without six, it is of 22 and 12: 3.18.
  const auto without = [](const std::set<Index>& points) {
    return openingsOf(hexagonalGrid(20, [&](Index i) { return points.count(i) == 0; }));
  };
  EXPECT_EQ(without({209, 210, 211, 229, 230}).size(), 1U);  // the boundary of the grid
  const std::vector<Opening> openings = without({209, 210, 211, 229, 230, 250});
  ASSERT_EQ(openings.size(), 2U);
  EXPECT_EQ(openings[1].loop.size(), 12U);
  EXPECT_NEAR(openings[1].width, 22.0 * std::sqrt(0.75) / 2.0 * 4.0 / 12.0, 1e-9);
  EXPECT_NEAR(openings[1].certainty, (openings[1].width - 3.0) / 6.0, 1e-9);
  // A slit of 60 points in one row is 3.4 wide, which would do for a hole, one of two rows 5.
  const auto with_slit = [](Index first, Index last) {
    const auto is_kept = [&](Index i) {
      return i / 80 < first || i / 80 > last || i % 80 < 10 || i % 80 >= 70;
    };
    return openingsOf(hexagonalGrid(80, is_kept)).size();
  };
  EXPECT_EQ(with_slit(8, 8), 1U);
  EXPECT_EQ(with_slit(8, 9), 2U);
}

}  // namespace
}  // namespace spherical_param::test
