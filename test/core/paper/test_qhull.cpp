#include "qhull.h"

#include "graphs.h"
#include "paper_method.h"
#include "spherical_param/sphere_triangulation.h"

namespace spherical_param::test {
namespace {

TEST(PaperHull, IsThatOfQhullOrWhereItLeavesPointsOutTheExactOne) {
  const Positions sphere = randomSphere(200, 1);
  const Eigen::Vector3d pole = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  const Positions crowded = horizontally(sphere, cap(400, 1e-8, pole, 2));
  EXPECT_EQ(hullByQhull(sphere).cols(), 396);
  ASSERT_EQ(hullByQhull(crowded).cols(), 0) << "this cap does not put qhull to the test";
  EXPECT_EQ(hullByQhull(horizontally(sphere, Eigen::Vector3d::Zero())).cols(), 0);  // inside
  for (const Positions& points : {sphere, crowded, horizontally(sphere, sphere)}) {
    const Triangles hull = internal::paper::convexHull(points, {});
    EXPECT_TRUE(isSphereOverAll(hull, static_cast<Index>(points.cols())));
    EXPECT_EQ(canonical(hull), canonical(triangulateSphere(points)));
  }
}

}  // namespace
}  // namespace spherical_param::test
