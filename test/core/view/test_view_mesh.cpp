#include "view_mesh.h"

#include "depth_images.h"
#include "exact_predicates.h"
#include "spherical_param/self_intersection.h"

namespace spherical_param::internal {
namespace {

using namespace test;

Triangles inFront(const ViewMesh& view) {
  std::vector<Index> kept;
  for (Index t = 0; t < view.triangles.cols(); ++t)
    if ((view.triangles.col(t).array() != view.behind).all())
      kept.push_back(t);
  return view.triangles(Eigen::all, kept);
}

/// Every triangle is outward from the place, and no two intersect.
void expectView(const Positions& points, const ViewMesh& view) {
  const Triangles triangles = inFront(view);
  ASSERT_GT(triangles.cols(), 0);
  for (const auto& t : triangles.colwise())
    ASSERT_GT(orientation3d(view.place, points.col(t[0]), points.col(t[1]), points.col(t[2])), 0);
  EXPECT_TRUE(findSelfIntersections(points, triangles).empty());
}

TEST(ViewMesh, IsClosedBehindThePlaceOrAllAroundIt) {
  const Positions image = depthImage(12, 9, boxBeforeWall);
  const ViewMesh front = triangulateView(image, Eigen::Vector3d::Zero(), {});
  EXPECT_EQ(front.behind, image.cols());
  EXPECT_TRUE(isSphereOverAll(front.triangles, static_cast<Index>(image.cols()) + 1));
  expectView(image, front);
  const Positions sphere = spiralSphere(300);
  const ViewMesh around = triangulateView(sphere, Eigen::Vector3d(0.3, 0.2, -0.4), {});
  EXPECT_EQ(around.behind, -1);
  EXPECT_TRUE(isSphereOverAll(around.triangles, 300));
  expectView(sphere, around);
}

TEST(ViewMesh, OfAnyNoiseDoesNotIntersectItself) {
  for (const double sigma : {0.01, 0.1, 0.3}) {
    const Positions points = withDepthNoise(depthImage(40, 30, ballInRoom), sigma, 3);
    ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
    const Triangles before = view.triangles;
    flipInView(points, view, {}, {});
    EXPECT_NE(view.triangles, before);
    expectView(points, view);
  }
}

TEST(ViewMesh, OfPointsOnOneRayIsFromAPlaceNearby) {
  const Positions image = depthImage(20, 20, boxBeforeWall);
  const Positions points = horizontally(image, Positions(0.5 * image));
  ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
  EXPECT_FALSE(view.place.isZero());
  EXPECT_LT(view.place.norm(), 0.1);
  EXPECT_TRUE(view.hidden.empty());
  flipInView(points, view, {}, {});
  expectView(points, view);
}

TEST(ViewMesh, LeavesOutWhatIsHiddenExactly) {
  Positions points = depthImage(60, 60, boxBeforeWall);
  points.col(17) = 2.0 * points.col(1830);  // one of 3,600 is no reason to look from elsewhere
  const ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
  EXPECT_TRUE(view.place.isZero());
  ASSERT_EQ(view.hidden.size(), 1U);
  EXPECT_TRUE(view.hidden[0] == 17 || view.hidden[0] == 1830);
  expectView(points, view);
}

TEST(ViewMesh, OfALatticeFromBetweenItsPointsDoesNotIntersectItself) {
  // Most rays go through several points, or along planes of them.
  const Positions lattice =
      pointsAt(216, [](Index i) { return Eigen::Vector3d(i / 36, i / 6 % 6, i % 6); });
  for (const auto& [i, j] : {std::pair(0, 1), {0, 215}, {3, 100}, {40, 41}, {7, 210}}) {
    const Eigen::Vector3d place = (lattice.col(i) + lattice.col(j)) / 2.0;
    const ViewMesh view = triangulateView(lattice, place, {});
    if (view.triangles.cols() > 0)
      expectView(lattice, view);
  }
}

TEST(ViewMesh, OfAFarPlaceIsNone) {
  const Positions image = depthImage(12, 9, boxBeforeWall);
  for (const double x : {1e15, 1e160, 1e308})
    EXPECT_EQ(triangulateView(image, Eigen::Vector3d(x, 0.0, 0.0), {}).triangles.cols(), 0);
  expectView(image, triangulateView(image, Eigen::Vector3d(0.0, 0.0, -1e6), {}));
}

TEST(ViewMesh, OfOnePlaneIsFromOutsideOfItAndOfALineThereIsNone) {
  Positions plane = randomCube(20, 5);
  plane.row(2).setZero();
  expectView(plane, triangulateView(plane, Eigen::Vector3d(0.5, 0.5, 2.0), {}));
  const ViewMesh edge_on = triangulateView(plane, Eigen::Vector3d(2.0, 0.1, 0.0), {});
  EXPECT_NE(edge_on.place.z(), 0.0);
  expectView(plane, edge_on);
  Positions line = plane;
  line.row(1).setZero();
  EXPECT_EQ(triangulateView(line, Eigen::Vector3d(0.5, 0.5, 2.0), {}).triangles.cols(), 0);
  EXPECT_EQ(directionsFrom(line.col(3), line).col(3), Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace spherical_param::internal
