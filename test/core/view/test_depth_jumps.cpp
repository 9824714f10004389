#include "depth_jumps.h"

#include "depth_images.h"
#include "spherical_param/mesh_topology.h"

namespace spherical_param::internal {
namespace {

using namespace test;

/// What is seen from the origin.
Triangles openedOf(const Positions& points) {
  ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
  flipInView(points, view, {}, {});
  return openJumps(points, spacingOf(points, {}), view, 50).surfaceTriangles();
}

TEST(DepthJumps, OfASurfaceSeenAtAFlatAngleAreNone) {
  // A floor 1.5 below the camera, to 13 away: the rows there are far apart.
  const Positions points = depthImage(80, 80, [](double, double y) { return 1.5 / (y + 0.615); });
  EXPECT_EQ(checkTopology(openedOf(points), columnCount(points)).components, 1U);
}

TEST(DepthJumps, LeaveFalsePointsBetweenSurfacesOut) {
  const Positions points = depthImage(80, 60, [](double x, double y) {
    const double depth = boxBeforeWall(x, y);
    const bool is_mixed = depth == 3.0 && boxBeforeWall(x - 0.0125, y) == 2.0;
    return is_mixed && std::fmod(std::abs(y) * 60.0, 4.0) < 1.0 ? 2.5 : depth;
  });
  const Triangles surface = openedOf(points);
  EXPECT_EQ(checkTopology(surface, columnCount(points)).components, 2U);
  for (const auto& t : surface.colwise())
    EXPECT_NE(points.row(2)(t).minCoeff() == 2.0 && points.row(2)(t).maxCoeff() == 3.0, true);
}

TEST(DepthJumps, SmallGapsWithoutPointsInsideAreFilledAndNotListed) {
  const Positions points = depthImage(20, 20, [](double x, double) { return 2.0 + 0.1 * x; });
  const ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
  const Indexed<double> spacing = spacingOf(points, {});
  const SphereMesh whole = openJumps(points, spacing, view, 50);
  using Counts = std::pair<std::size_t, std::size_t>;  // boundary loops, listed gaps
  const auto filled = [&](const std::vector<Index>& gap, const GapLimits& most) {
    SphereMesh mesh = whole;
    for (const Index t : gap)
      mesh.setOpen(t, true);
    const std::size_t listed = fillGaps(points, spacing, view, most, mesh).size();
    return Counts(checkTopology(mesh.surfaceTriangles(), 400).boundary_loops, listed);
  };
  std::vector<Index> around;  // a point in the middle
  whole.forEachAround(210, [&](Index t, int) { around.push_back(t); });
  const std::vector<Index> two{around[0], whole.neighbor(around[0], 0)};
  EXPECT_EQ(filled(two, {0, 0}), Counts(2, 0));
  EXPECT_EQ(filled(two, {8, 0}), Counts(1, 0));
  EXPECT_EQ(filled(around, {8, 0}), Counts(2, 0));  // the point may be far behind
  EXPECT_EQ(filled(around, {8, 100}), Counts(1, 1));
}

}  // namespace
}  // namespace spherical_param::internal
