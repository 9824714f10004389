#include "common/report_mesh.h"

#include "spherical_param/mesh_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr Index kRings = 40;
constexpr Index kSpokes = 60;
constexpr double kStep = 2.0 * 3.141592653589793 / kSpokes;  // [rad]

/// Adds a disc with a hole, at a height, as a sensor at the origin sees it. One triangle
/// intersects.
void addDisc(double height, std::vector<Point>& points, Result& result) {
  Surface disc;
  disc.boundary.resize(2);
  Positions positions(3, kRings * kSpokes);
  std::vector<Index> corners;
  for (Index ring = 0; ring < kRings; ++ring)
    for (Index spoke = 0; spoke < kSpokes; ++spoke) {
      const Index v = ring * kSpokes + spoke;
      const Index next = ring * kSpokes + (spoke + 1) % kSpokes;
      const double radius = 0.3 + 0.7 * ring / (kRings - 1);
      const double angle = kStep * spoke;
      positions.col(v) << radius * std::cos(angle), radius * std::sin(angle), height;
      disc.input_of_vertex.push_back(static_cast<Index>(points.size()) + v);
      if (ring == 0 || ring == kRings - 1)
        disc.boundary[ring == 0 ? 0 : 1].push_back(v);
      if (ring + 1 < kRings)
        corners.insert(corners.end(), {v, next, v + kSpokes, next, next + kSpokes, v + kSpokes});
    }
  disc.triangles = Eigen::Map<const Triangles>(corners.data(), 3, 2 * (kRings - 1) * kSpokes);
  disc.points = positions;
  disc.sphere = positions.colwise().normalized();
  disc.diagnosis.triangle_marks.resize(corners.size() / 3);
  disc.diagnosis.triangle_marks[100] = triangle_mark::self_intersection;
  const std::vector<Point> added = toPoints(positions);
  points.insert(points.end(), added.begin(), added.end());
  result.surfaces.push_back(std::move(disc));
}

struct ReportOfTwoDiscs : testing::Test {
  CloudReconstruction cloud;
  std::vector<const Surface*> surfaces;

  ReportOfTwoDiscs() {
    auto data = std::make_shared<PointData>();
    addDisc(2.0, data->points, cloud.result);
    addDisc(3.0, data->points, cloud.result);
    cloud.data = data;
    surfaces = {&cloud.result.surfaces[0], &cloud.result.surfaces[1]};
  }
};

TEST_F(ReportOfTwoDiscs, HasAllVerticesTrianglesAndMarks) {
  const ReportMesh mesh = reportMesh(cloud, surfaces);
  ASSERT_EQ(mesh.positions.cols(), 2 * kRings * kSpokes);
  for (Index v = 0; v < mesh.positions.cols(); ++v)
    EXPECT_EQ(mesh.positions.col(v), cloud.data->position(static_cast<std::size_t>(
                                         mesh.inputs[static_cast<std::size_t>(v)])));
  std::vector<double> heights;  // of marked triangles
  for (std::size_t t = 0; t < mesh.marks.size(); ++t)
    if (mesh.marks[t] != 0) {
      const auto corners = mesh.triangles.col(static_cast<Eigen::Index>(t));
      heights.push_back(mesh.positions.row(2)(corners).mean());
      for (const Index v : corners) {
        const Index vertex = mesh.inputs[static_cast<std::size_t>(v)] % (kRings * kSpokes);
        EXPECT_TRUE((surfaces[0]->triangles.col(100).array() == vertex).any());
      }
    }
  EXPECT_EQ(heights, (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(mesh.triangles.cols(), 4 * (kRings - 1) * kSpokes);
  EXPECT_EQ(mesh.area_distortion.size(), 0);
}

TEST_F(ReportOfTwoDiscs, HasACommonSphereIfTheyAreSeenFromOnePlace) {
  EXPECT_EQ(reportMesh(cloud, surfaces).sphere.cols(), 0);
  cloud.result.view = View{};
  const ReportMesh mesh = reportMesh(cloud, surfaces);
  EXPECT_EQ(mesh.sphere, mesh.positions.colwise().normalized());
}

TEST_F(ReportOfTwoDiscs, SharesTheTrianglesOfThePageAndKeepsOpenings) {
  constexpr std::size_t most = (kRings - 1) * kSpokes;  // a quarter
  const ReportMesh mesh = reportMesh(cloud, surfaces, most);
  EXPECT_LE(mesh.marks.size(), most);
  EXPECT_GE(mesh.marks.size(), most / 2);
  // The area of the discs, which are polygons, without their holes.
  const double area = 2.0 * (1.0 - 0.3 * 0.3) * kSpokes / 2.0 * std::sin(kStep);
  EXPECT_NEAR(measureMesh(mesh.positions, mesh.triangles).area, area, 0.02 * area);
}

}  // namespace
}  // namespace spherical_param::tools
