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

  RunResult tool(const Words& arguments) const { return run(REMESH_TOOL, arguments); }
  json reportOf(const Words& arguments) const { return ToolTest::reportOf(REMESH_TOOL, arguments); }
  MeshFile remeshed(Words options) const {
    options.insert(options.begin(), {"in.ply", "out.ply"});
    const RunResult result = tool(options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
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
    const MeshFile mesh = remeshed({"-grid", grid, "-points", "1000"});
    EXPECT_EQ(mesh.vertexCount(), made);
    EXPECT_TRUE(mesh.isSphere());
    expectOnTheSurface(mesh);
  }
}

TEST_F(RemeshTool, EvenCloudsHaveThatManyPointsFarFromEachOther) {
  const MeshFile cloud = remeshed({"-grid", "even", "-points", "400"});
  ASSERT_EQ(cloud.vertexCount(), 400U);
  EXPECT_EQ(cloud.triangles.cols(), 0);
  expectOnTheSurface(cloud);
  const Positions points = cloud.points();
  double nearest = 1e9;
  for (Eigen::Index i = 0; i < 400; ++i)
    for (Eigen::Index k = 0; k < i; ++k)
      nearest = std::min(nearest, (points.col(i) - points.col(k)).norm());
  // The area is about 17.6: of random points some would be a hundredth of this apart.
  EXPECT_GT(nearest, 0.4 * std::sqrt(17.6 / 400));
}

TEST_F(RemeshTool, OutputHasAsManyPointsAsTheMeshUnlessTold) {
  EXPECT_EQ(reportOf({"in.ply", "out.ply"})["points"], 492);
  EXPECT_EQ(reportOf({"in.ply", "out.tif"})["points"], 486);
  const json even = reportOf({"in.ply", "out.pcd", "-grid", "even"});
  EXPECT_EQ(even["points"], 500);
  EXPECT_EQ(even["triangles"], 0);
  EXPECT_TRUE(even["closed"].is_null());
}

TEST_F(RemeshTool, SphereHasTheSameTrianglesAndColours) {
  const MeshFile mesh = remeshed({"-sphere", "sphere.ply", "-ascii"});
  const MeshFile sphere = this->mesh("sphere.ply");
  EXPECT_EQ(sphere.triangles, mesh.triangles);
  EXPECT_EQ(sphere.colors(), mesh.colors());
  EXPECT_EQ(sphere.properties.count("nx"), 0U);
  EXPECT_LT((sphere.points().colwise().norm().array() - 1.0).abs().maxCoeff(), 2e-7);
}

TEST_F(RemeshTool, MeshOfAGeometryImageIsTheOctahedralGridBitForBit) {
  ASSERT_EQ(tool({"in.ply", "image.tif", "-points", "1000"}).exit_code, 0);
  const json sized = reportOf({"in.ply", "sized.TIFF", "-side", "33"});
  EXPECT_EQ(sized["points"], 32 * 32 + 2);
  EXPECT_EQ(sized["grid"]["kind"], "octahedral");
  EXPECT_EQ(sized["grid"]["side"], 33);
  EXPECT_TRUE(sized["options"]["grid"].is_null());
  EXPECT_TRUE(content("sized.TIFF") == content("image.tif"));
  const json report = reportOf({"image.tif", "back.ply", "-sphere", "sphere.ply"});
  EXPECT_EQ(report["points"], 1026);
  EXPECT_EQ(report["closed"], true);
  EXPECT_EQ(report["grid"]["side"], 33);
  const MeshFile grid = remeshed({"-grid", "octahedral", "-points", "1000"});
  const MeshFile back = mesh("back.ply");
  EXPECT_TRUE(back.isSphere());
  EXPECT_EQ(back.points(), grid.points());
  EXPECT_EQ(back.triangles, grid.triangles);
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
  // The mean of the position over the sphere is c_00 Y_00; the map may be turned, so that of the
  // others the lengths alone are known: each axis has the length 3 sqrt(4 pi / 3).
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(coefficients[i]["l"], i == 0 ? 0 : 1);
    EXPECT_EQ(coefficients[i]["m"], i == 0 ? 0 : static_cast<int>(i) - 2);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = [&](std::size_t i) { return coefficients[i]["xyz"][axis].get<double>(); };
    EXPECT_NEAR(at(0) / std::sqrt(4.0 * kPi), center[static_cast<Eigen::Index>(axis)], 0.02);
    EXPECT_NEAR(std::hypot(at(1), at(2), at(3)), 3.0 * std::sqrt(4.0 * kPi / 3.0), 0.05);
  }
  // The mesh of the series is the series at the points of the sphere.
  const MeshFile series = mesh("series.ply");
  ASSERT_EQ(series.vertexCount(), 642U);
  EXPECT_TRUE(series.isSphere());
  const Eigen::VectorXd radii = (series.points().colwise() - center).colwise().norm();
  EXPECT_LT((radii.array() - 3.0).abs().maxCoeff(), 0.05);
}

TEST_F(RemeshTool, ReportHasAllKeys) {
  const json report = reportOf({"in.ply", "out.ply", "-points", "1000"});
  for (const char* key :
       {"input_points", "vertices", "mesh_triangles", "flipped_triangles", "points", "triangles",
        "components", "genus", "self_intersections", "mesh_self_intersections"})
    EXPECT_TRUE(report[key].is_number_integer()) << key;
  EXPECT_EQ(report["flipped_triangles"], 0);
  EXPECT_EQ(report["vertices"], 500);
  EXPECT_EQ(report["points"], 1002);
  EXPECT_EQ(report["triangles"], 2000);
  EXPECT_EQ(report["genus"], 0);
  EXPECT_EQ(report["self_intersections"], 0);
  for (const char* key : {"closed", "manifold", "oriented"})
    EXPECT_EQ(report[key], true) << key;
  for (const char* key : {"angle_distortion", "area_distortion"})
    for (const json& distortion : {report, report["embedding_distortion"]}) {
      EXPECT_GE(distortion[key]["mean"], 1.0) << key;
      EXPECT_GE(distortion[key]["p95"], distortion[key]["mean"]) << key;
      EXPECT_GE(distortion[key]["max"], distortion[key]["p95"]) << key;
    }
  EXPECT_TRUE(report["embedding_distortion"]["flipped_triangles"].is_number_integer());
  EXPECT_EQ(report["grid"]["kind"], "icosahedral");
  EXPECT_EQ(report["grid"]["frequency"], 10);
  EXPECT_TRUE(report["grid"]["side"].is_null());
  EXPECT_TRUE(report["harmonics"].is_null());
  EXPECT_EQ(report["untangling"]["self_intersections_before"], 0);
  EXPECT_EQ(report["untangling"]["moved"], 0);
  const MeshFile out = mesh("out.ply");
  EXPECT_NEAR(report["volume"], spherical_param::test::volumeOf(out.points(), out.triangles), 1e-9);
  EXPECT_LE(report["distance"]["mean"], report["distance"]["rms"]);
  EXPECT_LE(report["distance"]["rms"], report["distance"]["max"]);
  EXPECT_LT(report["distance"]["max"], 0.05);
  std::string stages;
  for (const json& stage : report["stages"])
    stages += stage["name"].get<std::string>() + " ";
  EXPECT_EQ(stages,
            "read neighbors graph openings embedding triangulation optimization quality map "
            "surface resample untangle verify write ");
  EXPECT_EQ(report["options"]["points"], 1000);
  EXPECT_EQ(report["options"]["fit"], "smooth");
  EXPECT_TRUE(report["options"]["degree"].is_null());
}

TEST_F(RemeshTool, OptionsOfTheMapAndTheFitReachThem) {
  const json even = reportOf({"in.ply", "out.ply", "-area-weight", "0.9"});
  const json conformal = reportOf({"in.ply", "out.ply", "-area-weight", "0"});
  EXPECT_LT(even["area_distortion"]["mean"], conformal["area_distortion"]["mean"]);
  EXPECT_GT(even["angle_distortion"]["mean"], conformal["angle_distortion"]["mean"]);
  const json valid_only = reportOf({"in.ply", "out.ply", "-map-sweeps", "0"});
  EXPECT_EQ(valid_only["flipped_triangles"], 0);
  EXPECT_NE(valid_only["area_distortion"], even["area_distortion"]);
  EXPECT_TRUE(valid_only["options"]["area_weight"].is_null());
  // A smooth surface is nearer to the ellipsoid than the triangles between the points.
  const auto deviation = [this](const std::string& fit) {
    const MeshFile mesh = remeshed({"-points", "1002", "-fit", fit});
    return (directionsOf(mesh.points()).colwise().norm().array() - 1.0).abs().mean();
  };
  EXPECT_LT(deviation("smooth"), 0.5 * deviation("linear"));
}

TEST_F(RemeshTool, VerbosePrintsStagesAndVerdict) {
  const RunResult result = tool({"in.ply", "out.ply", "-points", "1000", "-verbose"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  for (const char* text :
       {"\n  map ", "\n  resample ", "(the nearest possible to 1000)", "area distortion",
        "flipped on sphere   0", "closed              yes", "self-intersections  0", "distance",
        "\nverdict   A sound mesh.\n", "\nwritten   out.ply\n"})
    EXPECT_NE(result.output.find(text), std::string::npos) << text;
}

}  // namespace
