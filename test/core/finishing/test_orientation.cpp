#include "orientation.h"

#include "core/reconstructions.h"
#include "open_shapes.h"
#include "spherical_param/mesh_measures.h"

namespace spherical_param::test {
namespace {

Surface facing(const Positions& points, const CloudInfo& info) {
  Options options;
  options.details = true;
  Surface surface = reconstruct(points, options, {}, info).surface();
  // The map has the side of the mesh.
  EXPECT_GT(volumeOf(surface.sphere, surface.triangles), 0.0);
  return surface;
}

/// Positive if more of a surface faces up than down.
double areaUp(const Positions& points, const Surface& surface) {
  return areaWeightedNormals(verticesOf(points, surface), surface.triangles).row(2).sum();
}

TEST(Orientation, OfAClosedMeshIsOutwardOrThatOfTheNormals) {
  const Positions points = ellipsoid(400);
  EXPECT_EQ(facing(points, {}).faced_by, FacedBy::Outward);
  EXPECT_EQ(facing(points, {{}, Eigen::Vector3d::Zero(), {}}).faced_by, FacedBy::Outward);
  const Surface inward = facing(points, {-points, std::nullopt, {}});
  EXPECT_EQ(inward.faced_by, FacedBy::Normals);
  EXPECT_LT(inward.measures.volume, 0.0);
  EXPECT_EQ(facing(points, {points, std::nullopt, {}}).triangles, facing(points, {}).triangles);
  Positions some = -points;
  for (Index i = 0; i < 400; i += 3)
    some.col(i).setConstant(std::nan(""));
  EXPECT_EQ(facing(points, {some, std::nullopt, {}}).faced_by, FacedBy::Normals);
  // Normals without a common side, or without length, decide nothing.
  Positions mixed = points;
  mixed.leftCols(200) *= -1.0;
  EXPECT_EQ(facing(points, {mixed, std::nullopt, {}}).faced_by, FacedBy::Outward);
  EXPECT_EQ(facing(points, {0.0 * points, std::nullopt, {}}).faced_by, FacedBy::Outward);
}

TEST(Orientation, OfTerrainIsUpUnlessTheSensorSawItFromBelow) {
  Positions points = flatPatch(20);
  points.row(2) = 0.3 * points.row(0).array().sin();
  const Eigen::Vector3d center = points.rowwise().mean();
  const auto expect = [&](const CloudInfo& given, FacedBy by, double up) {
    const Surface surface = reconstruct(points, {}, {}, given).surface();
    EXPECT_EQ(surface.faced_by, by);
    EXPECT_GT(up * areaUp(points, surface), 0.0);
  };
  expect({}, FacedBy::Up, 1.0);
  expect({{}, center - 40.0 * Eigen::Vector3d::UnitZ(), {}}, FacedBy::Viewpoint, -1.0);
  expect({{}, center + 40.0 * Eigen::Vector3d::UnitZ(), {}}, FacedBy::Viewpoint, 1.0);
  // Far off, it hardly sees it.
  expect({{}, center + Eigen::Vector3d(500.0, 0.0, -20.0), {}}, FacedBy::Up, 1.0);
  const Positions down = (-Eigen::Vector3d::UnitZ()).replicate(1, points.cols());
  expect({down, center + 40.0 * Eigen::Vector3d::UnitZ(), {}}, FacedBy::Normals, -1.0);
  const Options consolidated = given("consolidation", "auto");
  EXPECT_EQ(reconstruct(points, consolidated, {}, {down, std::nullopt, {}}).surface().faced_by,
            FacedBy::Normals);
}

TEST(Orientation, OfABowlIsOutwardUnlessTheSensorLooksIntoIt) {
  const Positions points = hemisphere(600);
  const Surface outward = facing(points, {});
  EXPECT_EQ(outward.faced_by, FacedBy::Outward);
  const Eigen::Vector3d mouth = outward.openings[0].center;
  const Surface into = facing(points, {{}, 5.0 * mouth, {}});
  EXPECT_EQ(into.faced_by, FacedBy::Viewpoint);
  EXPECT_LT(areaUp(points, into) * areaUp(points, outward), 0.0);
}

TEST(Orientation, TheOriginIsAViewpointWithRowsOrApartFromThePoints) {
  Positions points = spiralSphere(50);
  points(0, 7) = std::nan("");
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  EXPECT_EQ(viewpointOf(points, origin, false), std::nullopt);
  EXPECT_EQ(viewpointOf(points, origin, true), origin);
  EXPECT_EQ(viewpointOf(points, 0.5 * Eigen::Vector3d::UnitX(), false),
            0.5 * Eigen::Vector3d::UnitX());
  points.row(1).array() += 1.1;
  EXPECT_EQ(viewpointOf(points, origin, false), origin);
}

}  // namespace
}  // namespace spherical_param::test
