#include "../reconstructions.h"
#include "graph_helpers.h"
#include "parts.h"
#include "spherical_param/errors.h"

#include <limits>
#include <numeric>

namespace spherical_param {
namespace {

using test::horizontally;
using test::randomSphere;
using test::spiralSphere;

std::vector<Index> numbers(Eigen::Index begin, Eigen::Index end) {
  std::vector<Index> result(static_cast<std::size_t>(end - begin));
  std::iota(result.begin(), result.end(), static_cast<Index>(begin));
  return result;
}

Positions movedTo(double x, const Positions& points) {
  return points.colwise() + Eigen::Vector3d(x, 0.0, 0.0);
}

TEST(Parts, AreTheSurfacesOfACloudTheLargestFirst) {
  const Positions small = movedTo(4.0, spiralSphere(300));
  const Positions points = horizontally(small, spiralSphere(500));
  const Parts found = findParts(points);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_TRUE(found.left_out.empty());
  EXPECT_EQ(found.parts[0].points, numbers(300, 800));
  EXPECT_EQ(found.parts[1].points, numbers(0, 300));
  EXPECT_EQ(found.parts[1].box_min, Eigen::Vector3d(small.rowwise().minCoeff()));
  EXPECT_EQ(found.parts[1].box_max, Eigen::Vector3d(small.rowwise().maxCoeff()));
}

TEST(Parts, OfOneSizeAreInTheOrderOfTheirPoints) {
  Positions points(3, 400);
  const Positions sphere = spiralSphere(200);
  for (Eigen::Index i = 0; i < 200; ++i) {
    points.col(2 * i) = sphere.col(i) + Eigen::Vector3d(9.0, 0.0, 0.0);
    points.col(2 * i + 1) = sphere.col(i);
  }
  const Parts found = findParts(points);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_EQ(found.parts[0].points[1], 2);
  EXPECT_EQ(found.parts[1].points[1], 3);
}

TEST(Parts, AreMeshedAsIfEachWereAlone) {
  const Positions first = randomSphere(700, 1);
  const Positions second = randomSphere(400, 2);
  const Positions points = horizontally(first, movedTo(2.5, second));
  const Parts found = findParts(points);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_EQ(test::surfaceOf(points(Eigen::all, found.parts[0].points)).triangles,
            test::surfaceOf(first).triangles);
  EXPECT_EQ(test::surfaceOf(points(Eigen::all, found.parts[1].points)).triangles,
            test::surfaceOf(movedTo(2.5, second)).triangles);
}

TEST(Parts, HoldAsManyPointsAsWanted) {
  const Positions points = horizontally(spiralSphere(300), movedTo(4.0, spiralSphere(40)));
  const Parts large = findParts(points);
  ASSERT_EQ(large.parts.size(), 1U);
  EXPECT_EQ(large.left_out, numbers(300, 340));
  EXPECT_EQ(findParts(points, 40).parts.size(), 2U);
  EXPECT_EQ(findParts(points, 41).parts.size(), 1U);
  const Parts none = findParts(points, 301);
  EXPECT_TRUE(none.parts.empty());
  EXPECT_EQ(none.left_out, numbers(0, 340));
  EXPECT_EQ(findParts(points, 1000).left_out, numbers(0, 340));
}

TEST(Parts, LeaveOutWhatIsFarFromAllAndKeepWhatIsNear) {
  const Positions sphere = spiralSphere(1000);
  Positions others(3, 3);
  others.col(0) = Eigen::Vector3d(3.0, 1.0, 0.0);
  others.col(1) = 1.05 * sphere.col(500);  // half a spacing above the surface
  others.col(2) = Eigen::Vector3d(0.0, 0.0, 0.3);
  const Parts found = findParts(horizontally(sphere, others));
  ASSERT_EQ(found.parts.size(), 1U);
  EXPECT_EQ(found.parts[0].points.size(), 1001U);
  EXPECT_EQ(found.parts[0].points.back(), 1001);
  EXPECT_EQ(found.left_out, (std::vector<Index>{1000, 1002}));
}

TEST(Parts, AreOneOfAClosedSurface) {
  for (const Positions& points : {spiralSphere(1000), randomSphere(1000, 5), test::cubeGrid(12),
                                  test::withNoise(spiralSphere(1000), 0.02, 4)}) {
    const Parts found = findParts(points);
    ASSERT_EQ(found.parts.size(), 1U);
    EXPECT_EQ(found.parts[0].points, numbers(0, points.cols()));
  }
}

TEST(Parts, HoldAllPointsOfAPosition) {
  const Positions sphere = spiralSphere(60);
  const Positions points = horizontally(horizontally(sphere, sphere), movedTo(4.0, sphere));
  const Parts found = findParts(points);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_EQ(found.parts[0].points, numbers(0, 120));
  EXPECT_EQ(findParts(horizontally(spiralSphere(30), spiralSphere(30)), 50).parts.size(), 0U);
}

TEST(Parts, DoNotDependOnThreads) {
  const Positions points = horizontally(randomSphere(3000, 1), movedTo(2.2, randomSphere(2000, 2)));
  const Parts one = findParts(points, 50, test::onThreads(1));
  const Parts four = findParts(points, 50, test::onThreads(4));
  ASSERT_EQ(one.parts.size(), four.parts.size());
  for (std::size_t i = 0; i < one.parts.size(); ++i)
    EXPECT_EQ(one.parts[i].points, four.parts[i].points);
  EXPECT_EQ(one.left_out, four.left_out);
}

TEST(Parts, OfNothingAreNone) {
  EXPECT_TRUE(findParts(Positions(3, 0)).parts.empty());
  EXPECT_EQ(findParts(Positions::Zero(3, 5)).left_out, numbers(0, 5));
}

TEST(Parts, RefuseWhatCannotBeUsed) {
  Positions points = spiralSphere(100);
  EXPECT_THROW(findParts(points, 3), InvalidInput);
  EXPECT_THROW(findParts(points, 50, test::onThreads(-1)), InvalidInput);
  points(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(findParts(points), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
