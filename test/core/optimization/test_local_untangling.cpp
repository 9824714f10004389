#include "local_untangling.h"

#include "helpers.h"
#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(LocalUntangling, FlipsApartAreCountedAndEndAfterTheirWork) {
  const Case of = scrambledEllipsoid(300, 0.5, 600, 3);
  internal::EnergyMesh mesh = meshOf(of);
  const auto pairs = [&] {
    return static_cast<int>(findSelfIntersections(of.points, mesh.mesh().triangles()).size());
  };
  internal::LocalUntangling local(mesh);
  local.watch(range(0, of.points.cols()));
  local.limitWork(0);
  EXPECT_EQ(local.flipApart(), 0);
  EXPECT_EQ(mesh.mesh().triangles(), of.triangles);
  local.limitWork(20);
  const int before = pairs();
  const int fewer = local.flipApart();
  EXPECT_GT(fewer, 0);
  EXPECT_EQ(pairs(), before - fewer);
  EXPECT_LE(local.work(), 20U + 9U);  // a search may begin below the limit
}

}  // namespace
}  // namespace spherical_param::test
