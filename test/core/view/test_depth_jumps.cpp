#include "depth_jumps.h"

#include "depth_images.h"
#include "spherical_param/mesh_topology.h"

namespace spherical_param::internal {
namespace {

using namespace test;

ViewMesh fromOrigin(const Positions& points) {
  ViewMesh view = triangulateView(points, Eigen::Vector3d::Zero(), {});
  flipInView(points, view, {}, {});
  return view;
}

SphereMesh opened(const Positions& points, const ViewMesh& view) {
  return openJumps(points, spacingOf(points, {}), view, 50);
}

MeshTopology topologyOf(const SphereMesh& mesh, const Positions& points) {
  return checkTopology(mesh.surfaceTriangles(), columnCount(points));
}

TEST(DepthJumps, DivideABoxFromTheWallBehindIt) {
  const Positions points = depthImage(60, 40, boxBeforeWall);
  const SphereMesh mesh = opened(points, fromOrigin(points));
  const MeshTopology topology = topologyOf(mesh, points);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented);
  EXPECT_TRUE(topology.unused_vertices.empty());
  EXPECT_EQ(topology.components, 2U);
  EXPECT_EQ(topology.boundary_loops, 3U);
  const Triangles surface = mesh.surfaceTriangles();
  for (const auto& t : surface.colwise())
    EXPECT_EQ(points.row(2)(t).minCoeff(), points.row(2)(t).maxCoeff());
}

TEST(DepthJumps, OfASurfaceSeenAtAFlatAngleAreNone) {
  // A floor 1.5 below the camera, to 13 away: the rows there are far apart.
  const Positions points = depthImage(80, 80, [](double, double y) { return 1.5 / (y + 0.615); });
  EXPECT_EQ(topologyOf(opened(points, fromOrigin(points)), points).components, 1U);
}

TEST(DepthJumps, LeaveFalsePointsBetweenSurfacesOut) {
  const Positions points = depthImage(80, 60, [](double x, double y) {
    const double depth = boxBeforeWall(x, y);
    const bool is_mixed = depth == 3.0 && boxBeforeWall(x - 0.0125, y) == 2.0;
    return is_mixed && std::fmod(std::abs(y) * 60.0, 4.0) < 1.0 ? 2.5 : depth;
  });
  const SphereMesh mesh = opened(points, fromOrigin(points));
  EXPECT_EQ(topologyOf(mesh, points).components, 2U);
  const Triangles surface = mesh.surfaceTriangles();
  for (const auto& t : surface.colwise())
    EXPECT_NE(points.row(2)(t).minCoeff() == 2.0 && points.row(2)(t).maxCoeff() == 3.0, true);
}

TEST(DepthJumps, GapsAreFilledUpToASize) {
  // Without one point, and without a patch of 19 times 19.
  const Positions all = depthImage(60, 60, [](double, double) { return 2.0; });
  std::vector<Index> kept;
  for (Index i = 0; i < 3600; ++i) {
    const Index row = i / 60;
    const Index column = i % 60;
    const bool is_in_patch = row >= 10 && row < 29 && column >= 10 && column < 29;
    if (!is_in_patch && i != 40 * 60 + 40)
      kept.push_back(i);
  }
  const Positions points = all(Eigen::all, kept);
  const ViewMesh view = fromOrigin(points);
  const Indexed<double> spacing = spacingOf(points, {});
  SphereMesh mesh = opened(points, view);
  EXPECT_TRUE(fillGaps(points, spacing, view, {8}, mesh).empty());
  EXPECT_EQ(topologyOf(mesh, points).boundary_loops, 2U);
  const std::vector<Gap> filled = fillGaps(points, spacing, view, {8, 100}, mesh);
  ASSERT_EQ(filled.size(), 1U);
  EXPECT_EQ(filled[0].triangles.size(), filled[0].loop.size() - 2);
  EXPECT_EQ(topologyOf(mesh, points).boundary_loops, 1U);
}

}  // namespace
}  // namespace spherical_param::internal
