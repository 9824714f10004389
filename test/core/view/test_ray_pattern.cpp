#include "ray_pattern.h"

#include "depth_images.h"
#include "neighbor_search.h"

namespace spherical_param::internal {
namespace {

using namespace test;

RayPattern patternOf(const Positions& points) {
  return {points, makeNeighborSearch(points)};
}

TEST(RayPattern, IsThatOfACameraFromItsPlaceAlone) {
  const RayPattern pattern = patternOf(withDepthNoise(depthImage(80, 60, ballInRoom), 0.002, 1));
  EXPECT_TRUE(pattern.isSensor(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(pattern.isSensor(Eigen::Vector3d(5.0, 0.0, 9.0)));
  const auto place = pattern.find(2);
  ASSERT_TRUE(place);
  EXPECT_LT(place->norm(), 0.6);  // of an extent of 5
}

TEST(RayPattern, OfAScannerWithinThePointsSpreadsWithTheDistance) {
  // A floor 1 below the scanner, in rings.
  const Positions floor = gridOf(40, 180, [](int ring, int i) {
    return onCircle(i * 2.0 * kPi / 180, std::tan(0.5 + 0.02 * ring), -1.0);
  });
  const RayPattern pattern = patternOf(floor);
  EXPECT_TRUE(pattern.isSpreadFrom(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(pattern.isSensor(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(pattern.isSpreadFrom(Eigen::Vector3d(0.0, 0.0, 50.0)));
}

TEST(RayPattern, OfAnEvenSurfaceIsNoSensors) {
  const RayPattern pattern = patternOf(spiralSphere(3000));
  EXPECT_FALSE(pattern.isSensor(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(pattern.find(2));
}

}  // namespace
}  // namespace spherical_param::internal
