#include "cloud_surfaces.h"

#include "core/reconstructions.h"
#include "graph_helpers.h"

namespace spherical_param::test {
namespace {

using Parts = std::vector<std::vector<Index>>;

Parts partsOf(const Positions& points, int min_points) {
  return findParts(points, given("min_points", min_points));
}

TEST(Parts, AreTheSurfacesOfACloudTheLargestFirst) {
  EXPECT_EQ(findParts(horizontally(movedTo(4.0, spiralSphere(300)), spiralSphere(500))),
            (Parts{range(300, 800), range(0, 300)}));
  for (const Positions& points : {spiralSphere(1000), randomSphere(1000, 5), cubeGrid(12),
                                  withNoise(spiralSphere(1000), 0.02, 4)})
    EXPECT_EQ(findParts(points), (Parts{range(0, points.cols())}));
}

TEST(Parts, OfOneSizeAreInTheOrderOfTheirPoints) {
  Positions points(3, 400);
  for (Eigen::Index i = 0; i < 200; ++i) {
    points.col(2 * i) = spiralSphere(200).col(i) + Eigen::Vector3d(9.0, 0.0, 0.0);
    points.col(2 * i + 1) = spiralSphere(200).col(i);
  }
  const Parts found = findParts(points);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0][1], 2);
  EXPECT_EQ(found[1][1], 3);
}

TEST(Parts, HaveMinPointsPositions) {
  const Positions points = horizontally(spiralSphere(300), movedTo(4.0, spiralSphere(40)));
  EXPECT_EQ(findParts(points), Parts{range(0, 300)});
  EXPECT_EQ(partsOf(points, 40).size(), 2U);
  EXPECT_EQ(partsOf(points, 41).size(), 1U);
  EXPECT_TRUE(partsOf(points, 301).empty());
  const Positions sphere = spiralSphere(60);
  const Positions twice = horizontally(sphere, sphere, movedTo(4.0, sphere));
  EXPECT_EQ(findParts(twice), (Parts{range(0, 120), range(120, 180)}));
  EXPECT_TRUE(partsOf(twice, 61).empty());
}

TEST(Parts, SmallSheetsBesideLargeOnesBelongToThem) {
  const Positions sphere = spiralSphere(4000);  // .06 apart
  const Positions cap = 0.2 * spiralSphere(100);
  EXPECT_EQ(findParts(horizontally(sphere, movedTo(1.35, cap))).size(), 1U);
  EXPECT_EQ(findParts(horizontally(sphere, movedTo(1.6, cap))).size(), 2U);
  const Positions half = spiralSphere(1000);
  EXPECT_EQ(findParts(horizontally(half, movedTo(2.2, half))).size(), 2U);
}

TEST(Parts, AreJoinedAlongARimWhereTheSpacingJumps) {
  // Contours of a tube with caps, four times as far apart as their points and those of the caps.
  const double step = 2.0 * kPi / 60;
  std::vector<Eigen::Vector3d> points;
  for (Index slice = 0; slice < 6; ++slice)
    for (Index i = 0; i < 60; ++i) {
      const double angle = step * (i + 0.5 * (slice % 2));
      points.emplace_back(std::cos(angle), std::sin(angle), 4.0 * step * slice);
    }
  for (const double z : {0.0, 20.0 * step})
    for (Index i = -10; i <= 10; ++i)
      for (Index k = -10; k <= 10; ++k)
        if (const Eigen::Vector3d p(step * i, step * k, z); p.head<2>().norm() < 1.0 - 0.7 * step)
          points.push_back(p);
  const Positions contours = positionsOf(points);
  EXPECT_EQ(findParts(contours), Parts{range(0, contours.cols())});
  const Surface surface = surfaceOf(contours);
  EXPECT_TRUE(isSphereOverAll(surface.triangles, static_cast<Index>(contours.cols())));
  EXPECT_EQ(surface.intersecting_triangles, 0U);
}

TEST(Parts, AreNotJoinedToNetsOfPointsInside) {
  // A net of 100 points in a sphere of 2,000, which their stars reach, but farther from each other.
  const Positions sphere = spiralSphere(2000);
  const Positions points = horizontally(sphere, 0.7 * randomSphere(100, 3));
  const NeighborLists lists = bruteForceNeighbors(points, 32);
  const Stars stars = test::starsOf(points, lists);
  const Graph agreed = agreedGraph(points, stars, {});
  std::size_t reaching = 0;
  for (Index i = 2000; i < 2100; ++i)
    for (const Index j : stars.of(i))
      reaching += j < 2000 ? 1 : 0;
  EXPECT_GT(reaching, 500U);
  EXPECT_EQ(joinedAlongRims(points, agreed, stars).neighbors, agreed.neighbors);
}

TEST(Parts, HoldWhatIsNearAndNotWhatIsFarFromAll) {
  const Positions sphere = spiralSphere(1000);
  Positions others(3, 3);
  others.col(0) = 1.05 * sphere.col(500);  // half a spacing above the surface
  others.col(1) = Eigen::Vector3d(3.0, 1.0, 0.0);
  others.col(2) = Eigen::Vector3d(0.0, 0.0, 0.3);
  EXPECT_EQ(findParts(horizontally(sphere, others), given("outliers", "none")),
            Parts{range(0, 1001)});
}

}  // namespace
}  // namespace spherical_param::test
