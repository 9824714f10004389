#include "point_spread.h"

#include "graphs.h"
#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using internal::areOnGrid;
using internal::areOnLines;
using internal::fillVolume;

TEST(PointSpread, SolidsFillAVolumeAndThickSurfacesDoNot) {
  EXPECT_TRUE(fillVolume(test::randomCube(3000, 1)));
  EXPECT_FALSE(fillVolume(test::randomCube(400, 1)));  // too few to tell
  EXPECT_FALSE(fillVolume(test::withNoise(test::spiralSphere(5000), 0.1, 2)));
  EXPECT_FALSE(fillVolume(test::randomSphere(1000, 3)));
  EXPECT_FALSE(fillVolume(Positions::Zero(3, 600)));
}

TEST(PointSpread, ContoursAreOnLinesUpToThreeTimesTheirDistance) {
  const auto contours = [](double ratio) {
    Positions points(3, 12 * 60);
    for (Index i = 0; i < 12 * 60; ++i)
      points.col(i) << i % 60, ratio * (i / 60), 0.3 * std::sin(0.1 * (i % 60));
    return points;
  };
  for (const double ratio : {1.0, 2.0})
    EXPECT_FALSE(areOnLines(contours(ratio), test::localDelaunayGraph(contours(ratio)).graph));
  for (const double ratio : {4.0, 8.0})
    EXPECT_TRUE(areOnLines(contours(ratio), test::localDelaunayGraph(contours(ratio)).graph));
}

TEST(PointSpread, AGridHasFewCoordinatesAlongTwoAxes) {
  Positions elevations(3, 144);
  for (Index i = 0; i < 144; ++i)
    elevations.col(i) << i % 12, i / 12, std::sin(i);
  EXPECT_TRUE(areOnGrid(elevations));
  EXPECT_TRUE(areOnGrid(test::cubeGrid(2)));
  EXPECT_FALSE(areOnGrid(test::randomSphere(200, 1)));
}

}  // namespace
}  // namespace spherical_param
