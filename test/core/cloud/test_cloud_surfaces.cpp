#include "cloud_surfaces.h"

#include "core/graph/graph_helpers.h"
#include "core/reconstructions.h"

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

TEST(Parts, AreJoinedAlongABoundaryWhereTheSpacingJumps) {
  // Contours of a tube with caps, four times as far apart as their points and those of the caps.
  const double step = 2.0 * kPi / 60;
  std::vector<Eigen::Vector3d> points;
  for (Index slice = 0; slice < 6; ++slice)
    for (Index i = 0; i < 60; ++i)
      points.push_back(onCircle(step * (i + 0.5 * (slice % 2)), 1.0, 4.0 * step * slice));
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

TEST(Parts, HoldWhatIsNearAndNotWhatIsFarFromAll) {
  const Positions sphere = spiralSphere(1000);
  const Positions points =
      horizontally(sphere, 1.05 * sphere.col(500),  // half a spacing above
                   Eigen::Vector3d(3.0, 1.0, 0.0), 0.3 * Eigen::Vector3d::UnitZ());
  EXPECT_EQ(findParts(points, given("outliers", "none")), Parts{range(0, 1001)});
}

/// Points in a box, none of them nearer to the unit sphere than 0.06.
Positions inBox(Index n, double half_size) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-half_size, half_size);
  Positions points(3, 0);
  while (points.cols() < n) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    if (std::abs(point.norm() - 1.0) > 0.06)
      points = horizontally(points, point);
  }
  return points;
}

void expectStray(const Positions& surface, const Positions& stray) {
  const Positions points = horizontally(surface, stray);
  EXPECT_EQ(outliersOf(points, OutlierMode::Auto), range(surface.cols(), points.cols()));
}

TEST(StrayPoints, AreClustersNetsAndPointsBetweenSheets) {
  for (const Positions& sphere : {spiralSphere(2000), randomSphere(2000, 1)})  // 0.08 apart
    expectStray(sphere, horizontally(movedTo(1.5, 0.01 * spiralSphere(3)),
                                     movedTo(-2.5, 0.1 * spiralSphere(25))));
  // A depth edge: the camera sees points that are on neither side.
  const Positions between{{5.0, 9.3, 14.1, 9.0}, {5.2, 9.1, 3.0, 16.0}, {10.0, 10.0, 6.0, 13.5}};
  expectStray(horizontally(sheet(20, 0.0, 0.05, 1), sheet(20, 20.0, 0.05, 2)), between);
  // A net of more than the neighbours of a point: their stars agree with each other.
  const Positions sphere = spiralSphere(20000);
  const Positions net = inBox(400, 1.5);
  expectStray(sphere, net);
  EXPECT_EQ(outliersOf(horizontally(sphere, net), OutlierMode::Deviation), range(20000, 20400));
}

TEST(StrayPoints, AreThoseALittleOffASurface) {
  // 5,000 points are 0.05 apart; on a noisy sphere the same distance is none.
  const Positions near = horizontally(1.03 * spiralSphere(7), 0.98 * spiralSphere(4));
  expectStray(spiralSphere(5000), near);
  EXPECT_TRUE(
      outliersOf(horizontally(withNoise(spiralSphere(5000), 0.01, 1), near), OutlierMode::Auto)
          .empty());
}

TEST(StrayPoints, HaveTheirDistanceInSpacings) {
  const Positions points = horizontally(spiralSphere(600), Eigen::Vector3d(0.0, 2.0, 0.0));
  const std::vector<StrayPoint> found = localDelaunayGraph(points).stray_points;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].point, 600);
  EXPECT_NEAR(found[0].distance, 1.0 / sphereSpacing(600), 0.2 * found[0].distance);
}

}  // namespace
}  // namespace spherical_param::test
