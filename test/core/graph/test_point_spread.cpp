#include "point_spread.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

/// Voxels of a curved sheet.
Positions membrane(int layers) {
  return gridOf(40 * layers, 40, [=](int row, int x) {
    const int y = row / layers;
    return Eigen::Vector3d(x, y, std::floor(8.0 * std::sin(x / 12.0)) + row % layers);
  });
}

/// Curves from the origin in all directions.
Positions branches(int count) {
  const Positions directions = spiralSphere(count);
  return gridOf(count, 80, [&](int branch, int i) -> Eigen::Vector3d {
    const double t = (i + 1.0) / 80.0;
    return t * directions.col(branch) + 0.3 * t * t * directions.col((branch + 7) % count);
  });
}

/// Single precision of points far from the origin.
Positions rounded(const Positions& points, double northing) {
  const Positions far = points.colwise() + Eigen::Vector3d(0.0, northing, 0.0);
  return far.cast<float>().cast<double>();
}

TEST(PointSpread, OfSolidsIsAVolumeAndOfSurfacesIsNot) {
  EXPECT_EQ(spreadOf(randomCube(3000, 1)), PointSpread::Volume);
  EXPECT_EQ(spreadOf(randomCube(400, 1)), PointSpread::Surface);  // too few to tell
  EXPECT_EQ(spreadOf(randomSphere(1000, 1)), PointSpread::Surface);
  for (const double noise : {0.5, 1.0, 2.0, 3.0})
    for (const int count : {600, 1000, 4000})
      EXPECT_EQ(spreadOf(withNoise(spiralSphere(count), noise * sphereSpacing(count), 1)),
                PointSpread::Surface)
          << count << " points, noise of " << noise << " spacings";
}

TEST(PointSpread, OfThreeVoxelsAcrossIsLayersAndOfTwoSheetsIsNot) {
  EXPECT_EQ(spreadOf(membrane(1)), PointSpread::Surface);
  EXPECT_EQ(spreadOf(membrane(2)), PointSpread::Surface);
  EXPECT_EQ(spreadOf(membrane(3)), PointSpread::Layers);
  EXPECT_EQ(spreadOf(membrane(5)), PointSpread::Layers);
  EXPECT_EQ(spreadOf(withNoise(membrane(3), 0.2, 1)), PointSpread::Surface);  // no voxels
}

TEST(PointSpread, OfCentreLinesIsCurvesAndOfScanLinesIsNot) {
  EXPECT_EQ(spreadOf(branches(20)), PointSpread::Curves);
  const Positions rings = gridOf(
      12, 120, [](int ring, int i) { return onCircle(2.0 * kPi / 120 * i, 1.0, 0.3 * ring); });
  EXPECT_EQ(spreadOf(rings), PointSpread::Surface);
  const Positions meridians = gridOf(24, 200, [](int line, int i) -> Eigen::Vector3d {
    const double height = std::cos(kPi * (i + 0.5) / 200);
    return onCircle(2.0 * kPi / 24 * line, std::sqrt(1.0 - height * height), height);
  });
  EXPECT_EQ(spreadOf(meridians), PointSpread::Surface);
}

TEST(PointSpread, StepsOfSinglePrecisionAreCoarseIfTheyAreWideForTheSpacing) {
  const Positions near = withNoise(
      gridOf(50, 50, [](int y, int x) { return Eigen::Vector3d(x, y, std::sin(x / 9.0)); }), 0.3,
      1);
  const auto steps_of = [&](double spacing, double northing) -> Eigen::Vector3d {
    return coarseSteps(rounded(spacing * near, northing), 0.45);
  };
  EXPECT_EQ(steps_of(0.5, 4.5e6), Eigen::Vector3d(0.0, 0.5, 0.0));
  EXPECT_EQ(steps_of(0.2, 4.5e6), Eigen::Vector3d(0.0, 0.5, 0.0));
  EXPECT_EQ(steps_of(4.0, 4.5e6), Eigen::Vector3d::Zero());
  EXPECT_EQ(steps_of(0.5, 0.0), Eigen::Vector3d::Zero());
  const Positions decimals = (10.0 * near).array().round() / 10.0;
  EXPECT_EQ(coarseSteps(decimals.colwise() + Eigen::Vector3d(0.0, 4.5e6, 0.0), 0.45),
            Eigen::Vector3d::Zero());
}

TEST(PointSpread, OfAFewRandomPointsIsScatteredAndOfASmallShapeIsNot) {
  const auto are_scattered = [](const Positions& points) {
    return areScattered(
        points, test::starsOf(points, bruteForceNeighbors(points, 12), bruteForceSearch(points)));
  };
  for (const int count : {40, 50, 60}) {
    EXPECT_TRUE(are_scattered(randomCube(count, 1)));
    EXPECT_FALSE(are_scattered(Eigen::Vector3d(1.0, 0.8, 0.6).asDiagonal() * spiralSphere(count)));
    EXPECT_FALSE(are_scattered(randomSphere(count, 1)));
  }
  for (const int side : {2, 3, 4, 5})
    EXPECT_FALSE(are_scattered(cubeGrid(side)));
}

}  // namespace
}  // namespace spherical_param::test
