// -parts and -min-points, used as a user does.

#include "handle_shapes.h"
#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Positions;
using tool_test::ellipsoid;
using tool_test::linesOf;
using tool_test::RunResult;
using Words = std::vector<std::string>;

/// 200 points of one ellipsoid, 300 of another and 60 of a plane, far from each other.
class PartsOption : public tool_test::ToolTest {
protected:
  void SetUp() override {
    std::string text = linesOf(small) + linesOf(large);
    write("two.xyz", text);
    for (int i = 0; i < 60; ++i)
      text += linesOf(Eigen::Vector3d(0.3 * (i % 10), 0.3 * (i / 10), 20.0));
    write("three.xyz", text);
  }
  RunResult tool(const Words& arguments) const {
    return expectSuccess(RECONSTRUCTION_TOOL, arguments);
  }

  const Positions small = ellipsoid(200);
  const Positions large = ellipsoid(300, {1.2, 0.9, 0.7}, {9.0, 0.0, 0.0});
};

TEST_F(PartsOption, EachMeshesEachPartToAFileOfItsOwnAsIfItWereAlone) {
  tool({"two.xyz", "out_%03d.ply", "-parts", "each", "-sphere", "sphere_%03d.ply", "-json",
        "report.json"});
  EXPECT_EQ(mesh("out_000.ply").points(), large);
  EXPECT_EQ(mesh("out_001.ply").points(), small);
  EXPECT_TRUE(mesh("out_000.ply").isSphere());
  EXPECT_EQ(mesh("sphere_001.ply").triangles, mesh("out_001.ply").triangles);
  write("alone.xyz", linesOf(large));
  tool({"alone.xyz", "alone.ply"});
  EXPECT_EQ(content("out_000.ply"), content("alone.ply"));

  const json report = json::parse(content("report.json"));
  EXPECT_EQ(report["points"], 500);
  EXPECT_EQ(report["left_out"]["other_parts"], json::array());
  ASSERT_EQ(report["parts"].size(), 2U);
  const json& part = report["parts"][0];
  tool_test::expectEntries(part, {{"points", 300},
                                  {"output", "out_000.ply"},
                                  {"triangles", 596},
                                  {"diagnosis", {{"kind", "closed_genus0"}}}});
  EXPECT_GT(part["measures"]["box_min"][0], 7.0);
}

TEST_F(PartsOption, EachMeshesAllPartsToOneFileAndNamesThoseThatItCannotMesh) {
  const RunResult result =
      tool({"three.xyz", "out.ply", "-surface", "closed", "-json", "report.json"});
  const tool_test::MeshFile out = mesh("out.ply");
  EXPECT_EQ(out.triangles.cols(), 596 + 396);
  EXPECT_EQ(out.points().leftCols(300), large);
  EXPECT_EQ(out.points().rightCols(200), small);
  EXPECT_EQ(out.triangles.rightCols(396).minCoeff(), 300);
  const json report = json::parse(content("report.json"));
  EXPECT_EQ(report["parts"].size(), 2U);
  EXPECT_EQ(report["left_out"]["other_parts"].size(), 60U);
  const std::string failure = "1 part (60 points) cannot be meshed";
  EXPECT_NE(report["failures"].dump().find(failure), std::string::npos);
  EXPECT_NE(result.errors.find("warning: " + failure), std::string::npos);
  EXPECT_EQ(
      run(RECONSTRUCTION_TOOL, {"three.xyz", "out.ply", "-surface", "closed", "-strict"}).exit_code,
      1);
  tool({"three.xyz", "open.ply"});
  EXPECT_EQ(mesh("open.ply").points().cols(), 560);
}

TEST_F(PartsOption, OneSphereAndOnePageAreThoseOfTheLargest) {
  for (const std::string output : {"out.ply", "out_%03d.ply"}) {
    const RunResult result = tool({"two.xyz", output, "-sphere", "s.ply", "-json", "r.json"});
    EXPECT_NE(result.output.find("s.ply (the largest)"), std::string::npos) << result.output;
    EXPECT_EQ(mesh("s.ply").vertexCount(), 300U);
    EXPECT_EQ(json::parse(content("r.json"))["parts"].size(), 2U);
  }
  const std::string torus = linesOf(spherical_param::test::torusCloud(24, 10, 0.8, 0.3));
  write("with_torus.xyz", torus + linesOf(large));
  tool({"with_torus.xyz", "out_%03d.ply", "-sphere", "s.ply"});  // the torus has none
  EXPECT_EQ(mesh("s.ply").vertexCount(), 300U);
}

TEST_F(PartsOption, OthersThanTheLargestAreLeftOutInEveryTool) {
  for (const Words& words : {Words{"largest"}, Words{"each", "-min-points", "201"}}) {
    tool(tool_test::with({"two.xyz", "out.ply", "-json", "r.json", "-parts"}, words));
    EXPECT_EQ(mesh("out.ply").points(), large);
    EXPECT_EQ(json::parse(content("r.json"))["left_out"]["other_parts"].size(), 200U);
  }
  // Tools that make one surface take the largest, or all.
  for (const std::string program : {REMESH_TOOL, TEXTURE_TOOL})
    for (const auto& [topology, points] : {std::pair("scan", 300), std::pair("sphere", 500)}) {
      run(program, {"two.xyz", "out.ply", "-topology", topology, "-json", "r.json"});
      EXPECT_EQ(json::parse(content("r.json"))["vertices"], points) << program;
    }
  EXPECT_EQ(run(REMESH_TOOL, {"two.xyz", "even.ply", "-parts", "each"}).exit_code, 2);
}

TEST_F(PartsOption, EightPartsShareOneTimeLimit) {
  std::string text;
  for (int part = 0; part < 8; ++part)
    text += linesOf(ellipsoid(100, {1.0, 0.8, 0.6}, {4.0 * part, 0.0, 0.0}));
  write("eight.xyz", text);
  const RunResult result =
      tool({"eight.xyz", "out.ply", "-parts", "each", "-time-limit", "0", "-json", "report.json"});
  EXPECT_NE(
      result.errors.find("part 1, part 2, part 3, part 4, part 5, part 6, part 7, part 8: the "
                         "time limit ended the work early"),
      std::string::npos)
      << result.errors;
  EXPECT_EQ(mesh("out.ply").triangles.cols(), 8 * 196);
  for (const json& part : json::parse(content("report.json"))["parts"])
    EXPECT_EQ(part["is_out_of_time"], true);
}

}  // namespace
