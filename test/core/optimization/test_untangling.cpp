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
    const internal::IntersectingPairs found = bench.findIntersections();
    EXPECT_GT(found.pairs.size(), 30U);
    EXPECT_TRUE(internal::untangle(bench, found, rounds_by_energy).pairs.empty());
    EXPECT_TRUE(findSelfIntersections(of.points, bench.mesh.mesh().triangles()).empty());
    EXPECT_TRUE(isSphereOverAll(bench.mesh.mesh().triangles(), 300));
  }
}

TEST(Untangling, ReportsWhatIsLeftOfATangle) {
  const Case of = tangle(100);
  internal::Workbench bench(of.points, of.triangles, of.graph, {}, {});
  const auto left = internal::untangle(bench, bench.findIntersections(), 2);
  EXPECT_FALSE(left.is_sample);
  EXPECT_EQ(left.pairs, findSelfIntersections(of.points, bench.mesh.mesh().triangles()));
  // A sample is left alone.
  const Triangles before = bench.mesh.mesh().triangles();
  bench.renewWork();
  EXPECT_TRUE(internal::untangle(bench, {left.pairs, true}, 2).is_sample);
  EXPECT_EQ(bench.mesh.mesh().triangles(), before);
}

}  // namespace
}  // namespace spherical_param::test
