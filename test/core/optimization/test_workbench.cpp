#include "workbench.h"

#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

#include <chrono>
#include <thread>

namespace spherical_param::test {
namespace {

TEST(Workbench, RepairsUntilItsWorkIsDoneOrItsTimeIsOver) {
  const Case of = noisySphere(300, 0.5, 2);
  Workbench bench(of.points, SphereMesh(of.triangles, 300), of.graph, {}, {});
  EXPECT_EQ(bench.findIntersections().pairs, findSelfIntersections(of.points, of.triangles));
  std::size_t tried = 0;
  for (; bench.mayRepair() && tried < 10000000; tried += 12) {
    EXPECT_EQ(bench.log.recreated, tried);
    bench.tryPart({static_cast<Index>(tried % 300)}, 12, [](double) { return false; });
  }
  EXPECT_FALSE(bench.tryPart({0}, 12, [](double) { return true; }));
  EXPECT_EQ(bench.log.recreated, tried);
  EXPECT_EQ(bench.mesh.mesh().triangles(), of.triangles);  // nothing was accepted
  EXPECT_FALSE(bench.log.is_out_of_time);
  bench.renewWork();
  EXPECT_TRUE(bench.mayRepair());

  Execution hasty;
  hasty.time_limit = 0.0;
  Workbench late(of.points, SphereMesh(of.triangles, 300), of.graph, {}, hasty);
  EXPECT_FALSE(late.tryPart({0}, 12, [](double) { return true; }));
  EXPECT_TRUE(late.log.is_out_of_time);

  // Without any time the first flips end by themselves: the mesh is the same on any machine.
  hasty.time_limit = 1e-9;
  Workbench later(of.points, SphereMesh(of.triangles, 300), of.graph, {}, hasty);
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_FALSE(late.isOverdue());
  EXPECT_TRUE(later.isOverdue());
}

}  // namespace
}  // namespace spherical_param::test
