#include "workbench.h"

#include "optimization_cases.h"

#include <chrono>
#include <thread>

namespace spherical_param::test {
namespace {

TEST(Workbench, WithoutAnyTimeTheFirstFlipsEndByThemselves) {
  // The mesh is the same on any machine.
  const Case of = ellipsoid(100, 0.8, 0.6);
  const auto is_overdue = [&](double time_limit) {
    Execution execution;
    execution.time_limit = time_limit;
    const Workbench bench(of.points, SphereMesh(of.triangles, 100), of.graph, {}, execution);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    return bench.isOverdue();
  };
  EXPECT_FALSE(is_overdue(0.0));
  EXPECT_TRUE(is_overdue(1e-9));
}

}  // namespace
}  // namespace spherical_param::test
