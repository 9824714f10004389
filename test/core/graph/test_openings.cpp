#include "graphs.h"
#include "openings.h"

#include "graph_helpers.h"
#include "open_shapes.h"

#include <Eigen/Geometry>

namespace spherical_param {
namespace {

using test::flatPatch;
using test::hemisphere;
using test::pointsWhere;
using test::sphereWithHoles;
using test::spiralSphere;
using test::tube;

Graph graphOf(const Positions& points) {
  return test::graphOf(points, test::bruteForceNeighbors(points, 24)).graph;
}

std::vector<Opening> openingsOf(const Positions& points) {
  return findOpenings(points, graphOf(points)).openings;
}

TEST(Openings, AreNoneOfClosedSurfacesHoweverTheyAreSampled) {
  EXPECT_TRUE(openingsOf(spiralSphere(1500)).empty());
  EXPECT_TRUE(openingsOf(test::randomSphere(1500, 1)).empty());
  EXPECT_TRUE(openingsOf(test::cubeGrid(14)).empty());
}

TEST(Openings, AreAsManyAsThereAre) {
  EXPECT_EQ(openingsOf(hemisphere(800)).size(), 1U);
  EXPECT_EQ(openingsOf(tube(20, 40)).size(), 2U);
  for (const Index holes : {1, 2, 20})
    EXPECT_EQ(openingsOf(sphereWithHoles(4000, holes, 0.2)).size(),
              static_cast<std::size_t>(holes));
  // More than half of the sphere.
  EXPECT_EQ(openingsOf(pointsWhere(spiralSphere(3000),
                                   [](const Eigen::Vector3d& p) { return p.z() < -0.3; }))
                .size(),
            1U);
}

TEST(Openings, HaveTheSizesOfTheHole) {
  const Positions points = tube(20, 40);
  for (const Opening& opening : openingsOf(points)) {
    EXPECT_EQ(opening.loop.size(), 40U);
    EXPECT_NEAR(opening.boundary_length, 2.0 * test::kPi, 0.01);
    EXPECT_NEAR(opening.area, test::kPi, 0.02);
    EXPECT_NEAR(opening.width, 2.0, 0.02);
    EXPECT_NEAR(opening.spacing, 2.0 * test::kPi / 40, 0.03);
    EXPECT_LT(opening.center.head<2>().norm(), 1e-9);
    EXPECT_EQ(opening.certainty, 1.0);
    EXPECT_TRUE(opening.is_flat);
    EXPECT_FALSE(opening.is_filled);
  }
  EXPECT_FALSE(openingsOf(sphereWithHoles(2000, 1, 0.5)).front().is_flat);
}

TEST(Openings, CountFromThreeSpacingsOn) {
  // Hexagonal grid of distance 1. Without five points in two rows the hole is of 19 triangles and
  // 11 edges, a little less than 3 wide: 4 area / length = 2.99. Without six, it is of 22 and
  // 12: 3.18.
  Positions grid(3, 20 * 20);
  for (int row = 0; row < 20; ++row)
    for (int i = 0; i < 20; ++i)
      grid.col(20 * row + i) << i + 0.5 * (row % 2), std::sqrt(0.75) * row, 0.0;
  const auto without = [&](const std::set<Index>& points) {
    std::vector<Index> kept;
    for (Index i = 0; i < 400; ++i)
      if (points.count(i) == 0)
        kept.push_back(i);
    return openingsOf(grid(Eigen::all, kept));
  };
  const std::set<Index> five{209, 210, 211, 229, 230};
  EXPECT_EQ(without(five).size(), 1U);  // the rim of the grid
  const std::vector<Opening> openings = without({209, 210, 211, 229, 230, 250});
  ASSERT_EQ(openings.size(), 2U);
  EXPECT_EQ(openings[1].loop.size(), 12U);
  EXPECT_NEAR(openings[1].width, 22.0 * std::sqrt(0.75) / 2.0 * 4.0 / 12.0, 1e-9);
  EXPECT_NEAR(openings[1].certainty, (openings[1].width - 3.0) / 6.0, 1e-9);
  // A slit of 60 points in one row is 3.4 wide, which would do for a hole, one of two rows 5.
  Positions field(3, 80 * 20);
  for (int row = 0; row < 20; ++row)
    for (int i = 0; i < 80; ++i)
      field.col(80 * row + i) << i + 0.5 * (row % 2), std::sqrt(0.75) * row, 0.0;
  const auto with_slit = [&](int first, int last) {
    std::vector<Index> kept;
    for (Index i = 0; i < 1600; ++i)
      if (i / 80 < first || i / 80 > last || i % 80 < 10 || i % 80 >= 70)
        kept.push_back(i);
    return openingsOf(field(Eigen::all, kept)).size();
  };
  EXPECT_EQ(with_slit(8, 8), 1U);
  EXPECT_EQ(with_slit(8, 9), 2U);
  // Wider ones are more certain, up to 9 spacings: 3,000 points are 0.065 apart.
  EXPECT_LT(openingsOf(sphereWithHoles(3000, 1, 0.15)).at(0).certainty,
            openingsOf(sphereWithHoles(3000, 1, 0.25)).at(0).certainty);
  EXPECT_EQ(openingsOf(sphereWithHoles(3000, 1, 0.4)).at(0).certainty, 1.0);
}

TEST(Openings, OfAPlanePatchAreItsRimAndItsHoles) {
  const Positions patch = pointsWhere(flatPatch(40), [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(20.0, 20.0, 0.0)).norm() > 6.0;
  });
  const std::vector<Opening> openings = openingsOf(patch);
  ASSERT_EQ(openings.size(), 2U);
  EXPECT_NEAR(openings[0].area, 39.0 * 39.0, 50.0);
  EXPECT_NEAR(openings[1].area, 36.0 * test::kPi, 25.0);
}

TEST(Openings, AreTheSameMovedTurnedAndScaled) {
  const Positions points = sphereWithHoles(2000, 4, 0.3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Positions moved = (512.0 * (turn * points)).colwise() + Eigen::Vector3d(7.0, -3.0, 11.0);
  const auto sizes = [](const std::vector<Opening>& openings) {
    std::vector<std::size_t> edges;
    for (const Opening& opening : openings)
      edges.push_back(opening.loop.size());
    std::sort(edges.begin(), edges.end());
    return edges;
  };
  EXPECT_EQ(sizes(openingsOf(points)).size(), 4U);
  EXPECT_EQ(sizes(openingsOf(points)), sizes(openingsOf(moved)));
}

}  // namespace
}  // namespace spherical_param
