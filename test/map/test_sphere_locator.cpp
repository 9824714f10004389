#include "sphere_locator.h"

#include "map_shapes.h"

#include <gtest/gtest.h>

namespace spherical_param::internal {
namespace {

// Where directions are in a whole sphere: test_sphere_surface.cpp.

TEST(SphereLocator, OutsideOfTheTrianglesIsNowhere) {
  const Positions sphere = Positions::Identity(3, 3);
  const Triangles triangles = Eigen::Matrix<Index, 3, 1>(0, 1, 2);
  const SphereLocator locator(sphere, triangles, 1);
  EXPECT_EQ(locator.locate({-1.0, -1.0, -1.0}).triangle, -1);
  EXPECT_EQ(locator.locate({1.0, 1.0, -1e-90}).triangle, -1);
  const SphereLocation middle = locator.locate({2.0, 2.0, 2.0});
  EXPECT_EQ(middle.triangle, 0);
  EXPECT_LE((middle.weights - Eigen::Vector3d::Constant(1.0 / 3.0)).norm(), 1e-15);
  const SphereLocation side = locator.locate({1.0, 1.0, 0.0});
  EXPECT_EQ(side.triangle, 0);
  EXPECT_EQ(side.weights[2], 0.0);
}

}  // namespace
}  // namespace spherical_param::internal
