#include "point_spread.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

TEST(PointSpread, SolidsFillAVolumeAndSurfacesDoNot) {
  EXPECT_TRUE(fillVolume(randomCube(1000, 1)));
  EXPECT_FALSE(fillVolume(randomCube(400, 1)));  // too few to tell
  EXPECT_FALSE(fillVolume(randomSphere(1000, 1)));
  EXPECT_FALSE(fillVolume(withNoise(spiralSphere(1000), 2.0 * sphereSpacing(1000), 1)));
}

TEST(PointSpread, ElevationsAreOnAGridAndRandomPointsAreNot) {
  const Positions model =
      gridOf(20, 20, [](int y, int x) { return Eigen::Vector3d(x, y, std::sin(7.0 * x * x + y)); });
  EXPECT_TRUE(areOnGrid(model));
  EXPECT_FALSE(areOnGrid(withNoise(model, 1e-6, 1)));
}

}  // namespace
}  // namespace spherical_param::test
