#include "untangling.h"

#include "helpers.h"
#include "optimization_cases.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(Untangling, TakesIntersectingTrianglesApart) {
  for (const int rounds_by_energy : {0, 2}) {
    const Case of = scrambledEllipsoid(300, 0.5, 600, 3);
    internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
    const auto pairs = internal::findIntersections(bench.mesh);
    EXPECT_GT(pairs.size(), 30U);
    EXPECT_TRUE(internal::untangle(bench, pairs, rounds_by_energy).empty());
    EXPECT_TRUE(findSelfIntersections(of.points, bench.mesh.mesh().triangles()).empty());
    EXPECT_TRUE(isSphereOverAll(bench.mesh.mesh().triangles(), 300));
  }
}

TEST(Untangling, ReportsWhatIsLeftOfATangle) {
  const Case of = tangle(100);
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  const auto left = internal::untangle(bench, internal::findIntersections(bench.mesh), 2);
  EXPECT_EQ(left, findSelfIntersections(of.points, bench.mesh.mesh().triangles()));
}

}  // namespace
}  // namespace spherical_param::test
