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

/// Adds a disc with a hole, at a height, as a sensor at the origin sees it.
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
  const std::vector<Point> added = toPoints(positions);
  points.insert(points.end(), added.begin(), added.end());
  result.surfaces.push_back(std::move(disc));
}

TEST(ReportMesh, OfTwoSurfacesSharesTheTrianglesOfThePageAndKeepsOpenings) {
  CloudReconstruction cloud;
  auto data = std::make_shared<PointData>();
  addDisc(2.0, data->points, cloud.result);
  addDisc(3.0, data->points, cloud.result);
  cloud.data = data;
  constexpr std::size_t most = (kRings - 1) * kSpokes;  // a quarter
  const ReportMesh mesh =
      reportMesh(cloud, {&cloud.result.surfaces[0], &cloud.result.surfaces[1]}, most);
  EXPECT_LE(mesh.marks.size(), most);
  EXPECT_GE(mesh.marks.size(), most / 2);
  // The area of the discs, which are polygons, without their holes.
  const double area = 2.0 * (1.0 - 0.3 * 0.3) * kSpokes / 2.0 * std::sin(kStep);
  EXPECT_NEAR(measureMesh(mesh.positions, mesh.triangles).area, area, 0.02 * area);
}

}  // namespace
}  // namespace spherical_param::tools
