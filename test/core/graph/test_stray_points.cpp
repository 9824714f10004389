#include "../reconstructions.h"
#include "graph_helpers.h"

namespace spherical_param::test {
namespace {

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
  Positions between(3, 4);
  between << 5.0, 9.3, 14.1, 9.0,  //
      5.2, 9.1, 3.0, 16.0,         //
      10.0, 10.0, 6.0, 13.5;
  expectStray(horizontally(sheet(20, 0.0, 0.05, 1), sheet(20, 20.0, 0.05, 2)), between);
  // A net of more than the neighbours of a point: their stars agree with each other.
  const Positions sphere = spiralSphere(20000);
  const Positions net = inBox(400, 1.5);
  expectStray(sphere, net);
  EXPECT_EQ(outliersOf(horizontally(sphere, net), OutlierMode::Deviation), range(20000, 20400));
}

TEST(StrayPoints, BelowTheThresholdOfTheDeviationStay) {
  EXPECT_TRUE(outliersOf(horizontally(randomSphere(2000, 1), 1.5 * spiralSphere(6)),
                         OutlierMode::Deviation, 1000.0)
                  .empty());
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

TEST(StrayPoints, ThatAreNotLeftOutAreVerticesAndReported) {
  const Positions stray = 1.6 * spiralSphere(5);
  const Surface result =
      surfaceOf(horizontally(stray, spiralSphere(800), stray.leftCols(2)), sphere());
  EXPECT_EQ(result.outliers, (std::vector<Index>{0, 1, 2, 3, 4}));
  EXPECT_EQ(result.vertexCount(), 805U);
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings[0].text, "5 stray points in the mesh");
}

}  // namespace
}  // namespace spherical_param::test
