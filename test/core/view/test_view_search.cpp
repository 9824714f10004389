#include "view_search.h"

#include "depth_images.h"
#include "depth_jumps.h"
#include "handle_shapes.h"
#include "neighbor_search.h"
#include "open_shapes.h"
#include "ordered_points.h"

namespace spherical_param::internal {
namespace {

using namespace test;

std::optional<FoundView> found(const Positions& points,
                               const Eigen::Vector3d& viewpoint = Eigen::Vector3d::Zero()) {
  const OrderedPoints nodes = orderPoints(points, 1);
  return findView(nodes.points, viewpoint * std::ldexp(1.0, -nodes.exponent),
                  makeNeighborSearch(nodes.points), {});
}

Positions room(int columns, int rows) {
  return withDepthNoise(depthImage(columns, rows, ballInRoom), 0.002, 1);
}

/// A hilly terrain in lines.
Positions terrain(Index n) {
  const Positions places = randomCube(n, 4);
  return pointsAt(n, [&](Index i) {
    const double x = 100.0 * places(0, i);
    const double y = 100.0 * places(1, i);
    return Eigen::Vector3d(x, y, 4.0 * std::sin(0.1 * x) * std::cos(0.13 * y));
  });
}

TEST(ViewSearch, FindsTheOriginTheViewpointAndTheSheet) {
  const auto at_origin = found(room(60, 50));
  ASSERT_TRUE(at_origin);
  EXPECT_EQ(at_origin->source, ViewSource::Origin);
  const Positions moved = elsewhere(room(60, 50));
  const auto given = found(moved, elsewhere(Positions::Zero(3, 1)).col(0));
  ASSERT_TRUE(given);
  EXPECT_EQ(given->source, ViewSource::Given);
  EXPECT_FALSE(found(moved));  // too few points for a search
  const auto above = found(terrain(6000));
  ASSERT_TRUE(above);
  EXPECT_EQ(above->source, ViewSource::Above);
  EXPECT_GT(above->mesh.place.z(), 100.0);
}

TEST(ViewSearch, FindsWhereRaysComeFrom) {
  const OrderedPoints nodes = orderPoints(elsewhere(room(170, 130)), 1);
  const auto view =
      findView(nodes.points, Eigen::Vector3d::Zero(), makeNeighborSearch(nodes.points), {});
  ASSERT_TRUE(view);
  EXPECT_EQ(view->source, ViewSource::Rays);
  const Eigen::Vector3d place = std::ldexp(1.0, nodes.exponent) * view->mesh.place;
  // Of an extent of 5: from there the depth jumps as little as from the true place.
  EXPECT_LT((place - elsewhere(Positions::Zero(3, 1)).col(0)).norm(), 0.3);
}

TEST(ViewSearch, FindsNoneOfObjects) {
  EXPECT_FALSE(found(spiralSphere(30000)));   // from whose middle rays are even
  EXPECT_FALSE(found(torusCloud(200, 110)));  // around
  EXPECT_FALSE(found(torusCloud(60, 20)));    // as thick as 4 spacings
  EXPECT_FALSE(found(sphereWithHoles(6000, 3, 0.3)));
  EXPECT_FALSE(found(tube(40, 60)));
  // A file's viewpoint is no reason to open a closed surface, however thin.
  EXPECT_FALSE(found(spiralSphere(3000), Eigen::Vector3d(0.0, 0.0, 9.0)));
  const Positions lens = Eigen::Vector3d(1.0, 1.0, 0.08).asDiagonal() * spiralSphere(3000);
  EXPECT_FALSE(found(lens, Eigen::Vector3d(0.0, 0.0, 9.0)));
  // A second layer above a part of a sheet.
  const Positions sheet = terrain(6000);
  Positions part = terrain(9000).leftCols(3000);
  part.row(2).array() += 3.0;
  EXPECT_FALSE(found(horizontally(sheet, part)));
}

TEST(ViewSearch, RecognisesElevationGrids) {
  const Positions grid = gridOf(20, 30, [](int row, int column) {
    return Eigen::Vector3d(column, 0.5 * row, std::sin(0.3 * column));
  });
  EXPECT_TRUE(isElevationGrid(grid));
  EXPECT_FALSE(isElevationGrid(terrain(600)));
}

TEST(ViewSearch, SightOfTwoLayersIsRoughOrMixed) {
  const auto sight = [](const Positions& points) {
    return assessView(points, spacingOf(points, {}),
                      triangulateView(points, Eigen::Vector3d::Zero(), {}));
  };
  const Positions image = depthImage(60, 50, boxBeforeWall);
  EXPECT_TRUE(sight(image).isOneLayer());
  EXPECT_LT(sight(image).layers, 0.001);
  const Positions other = depthImage(59, 49, [](double, double) { return 1.0; });
  EXPECT_FALSE(sight(horizontally(image, other)).isOneLayer());
  EXPECT_GT(sight(horizontally(image, other)).layers, 0.1);
  const Positions near = depthImage(59, 49, [](double x, double y) {
    return boxBeforeWall(x, y) - 0.12;  // three spacings
  });
  EXPECT_FALSE(sight(horizontally(image, near)).isOneLayer());
}

}  // namespace
}  // namespace spherical_param::internal
