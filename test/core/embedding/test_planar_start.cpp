#include "planar_start.h"

#include "embeddings.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using namespace test;

TEST(PlanarStart, IsUnfolded) {
  // Tutte's theorem: only the outer face may be turned over. A few large triangles next to it may
  // be as well, since straight edges in the plane are not great circles on the sphere.
  const Mesh tube = bentTube(20.0, 3.0, 12);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  const Positions u = internal::planarStart(graph, internal::centralNodes(graph).front());
  int outward = 0;
  for (Eigen::Index t = 0; t < tube.triangles.cols(); ++t) {
    const Eigen::Vector3d a = u.col(tube.triangles(0, t));
    const Eigen::Vector3d b = u.col(tube.triangles(1, t));
    const Eigen::Vector3d c = u.col(tube.triangles(2, t));
    outward += a.dot((b - a).cross(c - a)) > 0.0 ? 1 : 0;
  }
  EXPECT_LT(static_cast<double>(std::min<Eigen::Index>(outward, tube.triangles.cols() - outward)),
            0.02 * static_cast<double>(tube.triangles.cols()));
  EXPECT_LT(u.rowwise().mean().norm(), 0.06);
}

TEST(PlanarStart, CentralNodesOfATubeAreInItsMiddle) {
  const Mesh tube = bentTube(30.0, 0.0, 10);
  const Graph graph = graphOfMesh(tube.points, tube.triangles);
  EXPECT_NEAR(tube.points(0, internal::centralNodes(graph).front()), 15.0, 2.0);
}

}  // namespace
}  // namespace spherical_param
