#include "spherical_param/sphere_triangulation.h"

#include "graphs.h"

namespace spherical_param::test {
namespace {

TEST(SphereTriangulation, NoPointIsBeyondATriangle) {
  for (const Index n : {4, 5, 12, 150}) {
    const Positions points = randomSphere(n, 3);
    const Triangles hull = triangulateSphere(points);
    EXPECT_TRUE(isSphereOverAll(hull, n));
    for (const auto& t : hull.colwise()) {
      const Eigen::Vector3d a = points.col(t[0]);
      const Eigen::Vector3d normal = (points.col(t[1]) - a).cross(points.col(t[2]) - a);
      EXPECT_LT((normal.transpose() * (points.colwise() - a)).maxCoeff(), 1e-14);
    }
  }
}

}  // namespace
}  // namespace spherical_param::test
