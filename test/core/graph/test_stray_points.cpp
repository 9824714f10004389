#include "../reconstructions.h"
#include "graph_helpers.h"
#include "outliers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <limits>

namespace spherical_param {
namespace {

using test::horizontally;
using test::randomSphere;
using test::spiralSphere;

std::vector<Index> strayOf(const Positions& points, int threads = 0) {
  return findStrayPoints(points, test::onThreads(threads)).indices;
}

std::vector<Index> range(Eigen::Index begin, Eigen::Index end) {
  std::vector<Index> result(static_cast<std::size_t>(end - begin));
  std::iota(result.begin(), result.end(), static_cast<Index>(begin));
  return result;
}

Positions at(const Eigen::Vector3d& center, const Positions& points) {
  return points.colwise() + center;
}

/// Points in a box, none of them nearer to the unit sphere than `gap`.
Positions inBox(Index n, double half_size, double gap) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-half_size, half_size);
  Positions points(3, 0);
  while (points.cols() < n) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    if (std::abs(point.norm() - 1.0) > gap)
      points = horizontally(points, point);
  }
  return points;
}

/// A square of m x m points with distance 1, turned a little so that no four are on a circle.
Positions sheet(int m, double height) {
  Positions points(3, m * m);
  for (int i = 0; i < m * m; ++i)
    points.col(i) << i % m + 0.05 * std::sin(7.0 * i), i / m + 0.05 * std::cos(5.0 * i), height;
  return points;
}

void expectFound(const Positions& surface, const Positions& stray) {
  const Positions points = horizontally(surface, stray);
  EXPECT_EQ(strayOf(points), range(surface.cols(), points.cols()));
}

TEST(StrayPoints, AreSinglePointsClustersAndNets) {
  for (const Positions& sphere : {spiralSphere(2000), randomSphere(2000, 1)}) {  // 0.08 apart
    for (const double radius : {0.6, 1.4, 2.0, 1e6})
      expectFound(sphere, radius * spiralSphere(6));
    // Dense clusters of 3 and 25 points.
    expectFound(sphere, horizontally(at({1.5, 0.0, 0.0}, 0.01 * spiralSphere(3)),
                                     at({0.0, 0.0, 2.5}, 0.1 * spiralSphere(25))));
  }
  // More than the neighbours of a point: their stars agree with each other.
  expectFound(spiralSphere(20000), inBox(400, 1.5, 0.06));
}

TEST(StrayPoints, AreThoseBetweenTwoSheets) {
  // A depth edge: the camera sees points that are on neither side.
  const Positions sheets = horizontally(sheet(20, 0.0), sheet(20, 20.0));
  Positions between(3, 4);
  between << 5.0, 9.3, 14.1, 9.0,  //
      5.2, 9.1, 3.0, 16.0,         //
      10.0, 10.0, 6.0, 13.5;
  expectFound(sheets, between);
}

TEST(StrayPoints, AreThoseALittleOffASurface) {
  // 5,000 points are 0.05 apart; on a noisy sphere the same distance is none.
  const Positions near = horizontally(1.03 * spiralSphere(7), 0.98 * spiralSphere(4));
  expectFound(spiralSphere(5000), near);
  EXPECT_TRUE(strayOf(horizontally(test::withNoise(spiralSphere(5000), 0.01, 1), near)).empty());
}

TEST(StrayPoints, ShapesHaveNoneHoweverTheyAreSampled) {
  Positions ellipsoid = spiralSphere(2000);
  ellipsoid.row(0) *= 6.0;
  const Positions half_dense =
      horizontally(spiralSphere(6000).leftCols(3000), spiralSphere(600).rightCols(300));
  for (const Positions& points :
       {spiralSphere(2000), randomSphere(2000, 2), randomSphere(60, 5), test::cubeGrid(15),
        ellipsoid, test::bentTube(20.0, 2.0, 16).points, half_dense,
        test::withNoise(spiralSphere(2000), 0.02, 4), spiralSphere(2000).leftCols(900).eval(),
        horizontally(spiralSphere(2000), at({3.0, 0.0, 0.0}, spiralSphere(300)))})
    EXPECT_TRUE(strayOf(points).empty()) << points.cols() << " points";
}

TEST(StrayPoints, AreTheSameMovedTurnedScaledAndPermuted) {
  const Positions points = horizontally(randomSphere(1500, 7), inBox(20, 1.5, 0.3));
  const std::vector<Index> expected = range(1500, 1520);
  ASSERT_EQ(strayOf(points), expected);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  EXPECT_EQ(strayOf(at({100.0, -50.0, 3.0}, turn * points)), expected);
  EXPECT_EQ(strayOf(1e-30 * points), expected);
  EXPECT_EQ(strayOf(1e30 * points), expected);
  EXPECT_EQ(strayOf(points.rowwise().reverse()), range(0, 20));
  // Of points at one position all or none.
  std::vector<Index> twice = expected;
  twice.push_back(1520);
  EXPECT_EQ(strayOf(horizontally(points, points.rightCols(1))), twice);
}

TEST(StrayPoints, HaveTheirDistanceInSpacingsForAnyNumberOfThreads) {
  const Positions points = horizontally(spiralSphere(6000), Eigen::Vector3d(0.0, 2.0, 0.0));
  const Outliers one = findStrayPoints(points, test::onThreads(1));
  EXPECT_EQ(one.indices, std::vector<Index>(1, 6000));
  ASSERT_EQ(one.scores.size(), 6001U);
  EXPECT_NEAR(one.scores[6000], 1.0 / test::sphereSpacing(6000), 0.2 * one.scores[6000]);
  EXPECT_EQ(one.scores[0], 0.0);
  for (const int threads : {2, 5, 0})
    EXPECT_EQ(findStrayPoints(points, test::onThreads(threads)).scores, one.scores);
}

TEST(StrayPoints, AreReportedByReconstructThatMakesVerticesOfThem) {
  const Positions stray = 1.6 * spiralSphere(5);
  const Positions points = horizontally(stray, spiralSphere(800));
  const Surface result = test::surfaceOf(horizontally(points, stray.leftCols(2)));
  EXPECT_EQ(result.outliers, range(0, 5));
  EXPECT_EQ(result.vertexCount(), 805U);
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings[0].text, "5 points look like outliers");

  const Surface clean = test::surfaceOf(points.rightCols(800));
  EXPECT_TRUE(clean.outliers.empty());
  EXPECT_TRUE(clean.findings.empty());
}

TEST(StrayPoints, OfSigmaAreJudgedByTheirDistanceAndHideNoOthers) {
  const Positions sphere = spiralSphere(20000);
  const Positions net = inBox(400, 1.5, 0.06);
  const Outliers found = findOutliers(horizontally(sphere, net));
  EXPECT_EQ(found.indices, range(20000, 20400));
  for (Index i = 20000; i < 20400; ++i)
    EXPECT_GT(found.scores[static_cast<std::size_t>(i)], found.threshold);
  OutlierOptions none;
  none.sigma = 1000.0;
  EXPECT_TRUE(findOutliers(horizontally(randomSphere(2000, 1), 1.5 * spiralSphere(6)), none)
                  .indices.empty());
}

TEST(StrayPoints, FewPointsHaveNoneAndBadOnesAreInvalidInput) {
  for (const Index n : {0, 1, 3, 4, 12, 31})
    EXPECT_TRUE(strayOf(randomSphere(n, 15)).empty());
  Positions broken = randomSphere(50, 1);
  broken(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(findStrayPoints(broken), InvalidInput);
  EXPECT_THROW(strayOf(randomSphere(50, 1), -1), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
