// pcl_spherical_param_remesh, run as a user does.

#include "tool_test.h"

#include "helpers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Positions;
using spherical_param::test::kPi;
using tool_test::ellipsoid;
using tool_test::expectEntries;
using tool_test::MeshFile;
using tool_test::RunResult;
using Words = std::vector<std::string>;

const Eigen::Vector3d axes(2.0, 1.0, 0.7);
const Eigen::Vector3d center(10.0, 0.0, 0.0);

/// Linear, so that what is interpolated between the points is as good as the surface there.
Positions colorsAt(const Positions& directions) {
  return 127.5 * (directions.colwise().normalized().array() + 1.0);
}

/// The directions of points near the ellipsoid, of length 1 on it.
Positions directionsOf(const Positions& points) {
  return (points.colwise() - center).array().colwise() / axes.array();
}

/// in.ply has 500 points of the ellipsoid, coloured by their directions.
class RemeshTool : public tool_test::ToolTest {
protected:
  void SetUp() override {
    const Positions points = ellipsoid(500, axes, center);
    write("in.ply",
          tool_test::plyOf(points, {}, colorsAt(directionsOf(points)).array().round().matrix()));
  }

  json reportOf(const Words& arguments) const { return ToolTest::reportOf(REMESH_TOOL, arguments); }
  MeshFile remeshed(const Words& options) const {
    expectSuccess(REMESH_TOOL, tool_test::with({"in.ply", "out.ply"}, options));
    return mesh("out.ply");
  }
};

void expectOnTheSurface(const MeshFile& mesh) {
  const Positions points = mesh.points();
  const Positions directions = directionsOf(points);
  EXPECT_LT((directions.colwise().norm().array() - 1.0).abs().maxCoeff(), 0.01);
  const Positions normals =
      (directions.array().colwise() / axes.array()).matrix().colwise().normalized();
  EXPECT_GT((mesh.normals().array() * normals.array()).colwise().sum().minCoeff(), 0.98);
  EXPECT_LT((mesh.colors() - colorsAt(directions)).cwiseAbs().maxCoeff(), 6.0);
}

TEST_F(RemeshTool, MeshesAreClosedOnTheSurfaceAndHaveTheNearestNumberOfPoints) {
  // 10 f^2 + 2 and 4 f^2 + 2.
  for (const auto& [grid, made] :
       {std::tuple("icosahedral", 1002U), std::tuple("octahedral", 1026U)}) {
    SCOPED_TRACE(grid);
    const MeshFile made_mesh = remeshed({"-grid", grid, "-points", "1000", "-sphere", "s.ply"});
    EXPECT_EQ(made_mesh.vertexCount(), made);
    EXPECT_TRUE(made_mesh.isSphere());
    expectOnTheSurface(made_mesh);
    const MeshFile sphere = mesh("s.ply");
    EXPECT_EQ(sphere.triangles, made_mesh.triangles);
    EXPECT_EQ(sphere.colors(), made_mesh.colors());
    EXPECT_EQ(sphere.properties.count("nx"), 0U);
    EXPECT_LT((sphere.points().colwise().norm().array() - 1.0).abs().maxCoeff(), 2e-7);
  }
}

TEST_F(RemeshTool, EvenCloudsHaveThatManyPointsOnTheSurface) {
  const MeshFile cloud = remeshed({"-grid", "even", "-points", "400"});
  ASSERT_EQ(cloud.vertexCount(), 400U);
  EXPECT_EQ(cloud.triangles.cols(), 0);
  expectOnTheSurface(cloud);
}

TEST_F(RemeshTool, OutputHasAsManyPointsAsTheMeshUnlessTold) {
  expectEntries(reportOf({"in.ply", "out.ply"}), {{"points", 492}});
  expectEntries(reportOf({"in.ply", "out.tif"}), {{"points", 486}});
  expectEntries(reportOf({"in.ply", "out.pcd", "-grid", "even"}),
                {{"points", 500}, {"triangles", 0}, {"closed", nullptr}});
}

TEST_F(RemeshTool, MeshOfAGeometryImageIsTheOctahedralGridBitForBit) {
  expectSuccess(REMESH_TOOL, {"in.ply", "image.tif", "-points", "1000"});
  expectEntries(reportOf({"in.ply", "sized.TIFF", "-side", "33"}),
                {{"points", 32 * 32 + 2},
                 {"grid", {{"kind", "octahedral"}, {"side", 33}}},
                 {"options", {{"grid", nullptr}}}});
  EXPECT_TRUE(content("sized.TIFF") == content("image.tif"));
  expectEntries(reportOf({"image.tif", "back.ply", "-sphere", "sphere.ply"}),
                {{"points", 1026}, {"closed", true}, {"grid", {{"side", 33}}}});
  const MeshFile grid = remeshed({"-grid", "octahedral", "-points", "1000"});
  EXPECT_EQ(mesh("back.ply").points(), grid.points());
  EXPECT_EQ(mesh("back.ply").triangles, grid.triangles);
  EXPECT_EQ(mesh("sphere.ply").triangles, grid.triangles);
}

TEST_F(RemeshTool, HarmonicsOfASphereAreItsCenterAndItsRadius) {
  write("sphere.xyz", tool_test::linesOf(ellipsoid(1000, {3.0, 3.0, 3.0}, center)));
  const json report = reportOf({"sphere.xyz", "series.ply", "-series", "-harmonics", "c.json",
                                "-degree", "4", "-points", "642"});
  const json file = json::parse(content("c.json"));
  EXPECT_EQ(file["degree"], 4);
  EXPECT_TRUE(file["convention"].is_string());
  const json& coefficients = file["coefficients"];
  ASSERT_EQ(coefficients.size(), 25U);
  EXPECT_LT(file["rms_residual"], 0.05);
  EXPECT_EQ(file["rms_residual"], report["harmonics"]["rms_residual"]);
  for (std::size_t i = 0; i < 4; ++i)
    expectEntries(coefficients[i],
                  {{"l", i == 0 ? 0 : 1}, {"m", i == 0 ? 0 : static_cast<int>(i) - 2}});
  // The mean of the position over the sphere is c_00 Y_00.
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(coefficients[0]["xyz"][axis].get<double>() / std::sqrt(4.0 * kPi),
                center[static_cast<Eigen::Index>(axis)], 0.02);
  // The mesh of the series is the series at the points of the sphere.
  const MeshFile series = mesh("series.ply");
  ASSERT_EQ(series.vertexCount(), 642U);
  EXPECT_TRUE(series.isSphere());
  const Eigen::VectorXd radii = (series.points().colwise() - center).colwise().norm();
  EXPECT_LT((radii.array() - 3.0).abs().maxCoeff(), 0.05);
}

TEST_F(RemeshTool, ReportIsThatOfTheWrittenMesh) {
  const json report = reportOf({"in.ply", "out.ply", "-points", "1000"});
  expectEntries(report, R"({
      "input_points": 500, "vertices": 500, "mesh_triangles": 996, "mesh_self_intersections": 0,
      "points": 1002, "triangles": 2000, "components": 1, "genus": 0, "self_intersections": 0,
      "closed": true, "manifold": true, "oriented": true, "harmonics": null,
      "grid": {"kind": "icosahedral", "frequency": 10, "side": null},
      "untangling": {"self_intersections_before": 0, "moved": 0},
      "options": {"points": 1000, "fit": "smooth", "area_weight": 0.5, "map_sweeps": 40,
                  "degree": null}})"_json);
  EXPECT_TRUE(report["embedding_distortion"]["flipped_triangles"].is_number_integer());
  const MeshFile out = mesh("out.ply");
  EXPECT_NEAR(report["volume"], spherical_param::test::volumeOf(out.points(), out.triangles), 1e-9);
  EXPECT_LE(report["distance"]["mean"], report["distance"]["rms"]);
  EXPECT_LE(report["distance"]["rms"], report["distance"]["max"]);
  EXPECT_LT(report["distance"]["max"], 0.05);
}

TEST_F(RemeshTool, OptionsOfTheMapAndTheFitReachThem) {
  const json even = reportOf({"in.ply", "out.ply", "-area-weight", "0.9"});
  const json conformal = reportOf({"in.ply", "out.ply", "-area-weight", "0"});
  EXPECT_LT(even["area_distortion"]["mean"], conformal["area_distortion"]["mean"]);
  const json valid_only = reportOf({"in.ply", "out.ply", "-map-sweeps", "0"});
  EXPECT_NE(valid_only["area_distortion"], even["area_distortion"]);
  EXPECT_TRUE(valid_only["options"]["area_weight"].is_null());
  EXPECT_NE(remeshed({"-fit", "smooth"}).points(), remeshed({"-fit", "linear"}).points());
}

TEST_F(RemeshTool, VerbosePrintsStagesAndVerdict) {
  const RunResult result =
      expectSuccess(REMESH_TOOL, {"in.ply", "out.ply", "-points", "1000", "-verbose"});
  EXPECT_EQ(result.errors, "");
  for (const char* text : {"\n  fit                 smooth\n", "\n  map ", "\n  resample ",
                           "\n  points              1002\n", "\n  flipped triangles   0\n",
                           "\n  area distortion     mean 1.", "\n  closed              yes\n",
                           "\n  self intersections  0\n", "\n  distance            mean 0.",
                           "\nverdict   A sound mesh.\n", "\nwritten   out.ply\n"})
    EXPECT_NE(result.output.find(text), std::string::npos) << text << result.output;
}

}  // namespace
