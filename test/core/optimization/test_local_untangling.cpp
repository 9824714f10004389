#include "local_untangling.h"

#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::test {
namespace {

int pairsOf(const Case& of, const EnergyMesh& mesh) {
  return static_cast<int>(findSelfIntersections(of.points, mesh.mesh().triangles()).size());
}

TEST(LocalUntangling, FlipsApartAreCountedAndEndAfterTheirWork) {
  const Case of = scrambledEllipsoid(300, 0.5, 600, 3);
  EnergyMesh mesh = meshOf(of);
  LocalUntangling local(mesh);
  local.watch(range(0, of.points.cols()));
  local.limitWork(0);
  EXPECT_EQ(local.flipApart(), 0);
  EXPECT_EQ(mesh.mesh().triangles(), of.triangles);
  local.limitWork(20);
  const int before = pairsOf(of, mesh);
  const int fewer = local.flipApart();
  EXPECT_GT(fewer, 0);
  EXPECT_EQ(pairsOf(of, mesh), before - fewer);
  EXPECT_LE(local.work(), 20U + 9U);  // a search may begin below the limit
}

TEST(LocalUntangling, AChangeIsCountedWithWhatFlipsMakeOfIt) {
  const Case of = noisySphere(300, 0.5, 2);
  EnergyMesh mesh = meshOf(of);
  LocalUntangling local(mesh);
  const int before = pairsOf(of, mesh);
  int repaired = 0;
  for (Index t = 0; t < mesh.mesh().size(); t += 20) {
    local.watch(range(0, of.points.cols()));
    mesh.begin();
    for (int k = 0; k < 3; ++k)
      mesh.flip(t, k, 0.0);
    const int tangled = pairsOf(of, mesh);
    const int difference = local.flipChangedApart();
    EXPECT_EQ(pairsOf(of, mesh), before + difference);
    EXPECT_LE(before + difference, tangled);
    repaired += before + difference < tangled ? 1 : 0;
    mesh.rollBack();
  }
  EXPECT_GT(repaired, 3);
}

}  // namespace
}  // namespace spherical_param::test
