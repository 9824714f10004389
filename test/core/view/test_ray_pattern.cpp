#include "ray_pattern.h"

#include "helpers.h"
#include "neighbor_search.h"

namespace spherical_param::internal {
namespace {

using namespace test;

TEST(RayPattern, OfAScannerWithinThePointsSpreadsWithTheDistance) {
  // A floor 1 below the scanner, in rings.
  const Positions floor = gridOf(40, 180, [](int ring, int i) {
    return onCircle(i * 2.0 * kPi / 180, std::tan(0.5 + 0.02 * ring), -1.0);
  });
  const RayPattern pattern(floor, makeNeighborSearch(floor));
  EXPECT_TRUE(pattern.isSpreadFrom(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(pattern.isSensor(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(pattern.isSpreadFrom(Eigen::Vector3d(0.0, 0.0, 50.0)));
}

}  // namespace
}  // namespace spherical_param::internal
