// -parts and -min-points, used as a user does.

#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>
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
    std::string text;
    for (const Positions& part : {small, large})
      for (Eigen::Index i = 0; i < part.cols(); ++i)
        text += linesOf(part.col(i));
    write("two.xyz", text);
    for (int i = 0; i < 60; ++i)
      text += linesOf(Eigen::Vector3d(0.3 * (i % 10), 0.3 * (i / 10), 20.0));
    write("three.xyz", text);
  }
  RunResult tool(const Words& arguments) const { return run(RECONSTRUCTION_TOOL, arguments, {}); }

  const Positions small = ellipsoid(200);
  /// As it is written: in single precision.
  const Positions large =
      (ellipsoid(300).colwise() + Eigen::Vector3d(9.0, 0.0, 0.0)).cast<float>().cast<double>();
};

TEST_F(PartsOption, EachMeshesEachPartToAFileOfItsOwnAsIfItWereAlone) {
  const RunResult result = tool({"two.xyz", "out_%03d.ply", "-parts", "each", "-sphere",
                                 "sphere_%03d.ply", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(mesh("out_000.ply").points(), large);
  EXPECT_EQ(mesh("out_001.ply").points(), small);
  EXPECT_TRUE(mesh("out_000.ply").isSphere());
  EXPECT_EQ(mesh("sphere_001.ply").triangles, mesh("out_001.ply").triangles);
  std::string alone;
  for (Eigen::Index i = 0; i < large.cols(); ++i)
    alone += linesOf(large.col(i));
  write("alone.xyz", alone);
  ASSERT_EQ(tool({"alone.xyz", "alone.ply"}).exit_code, 0);
  EXPECT_EQ(content("out_000.ply"), content("alone.ply"));

  const json report = json::parse(content("report.json"));
  EXPECT_EQ(report["points"], 500);
  EXPECT_EQ(report["left_out"]["other_parts"], json::array());
  ASSERT_EQ(report["parts"].size(), 2U);
  const json& part = report["parts"][0];
  EXPECT_EQ(part["points"], 300);
  EXPECT_EQ(part["output"], "out_000.ply");
  EXPECT_EQ(part["triangles"], 596);
  EXPECT_EQ(part["diagnosis"]["kind"], "closed_genus0");
  EXPECT_GT(part["measures"]["box_min"][0], 7.0);
}

TEST_F(PartsOption, EachMeshesAllPartsToOneFileAndNamesThoseThatItCannotMesh) {
  const RunResult result = tool({"three.xyz", "out.ply", "-parts", "each", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const tool_test::MeshFile out = mesh("out.ply");
  EXPECT_EQ(out.triangles.cols(), 596 + 396);
  EXPECT_EQ(out.points().leftCols(300), large);
  EXPECT_EQ(out.points().rightCols(200), small);
  EXPECT_EQ(out.triangles.rightCols(396).minCoeff(), 300);
  const json report = json::parse(content("report.json"));
  EXPECT_EQ(report["parts"].size(), 2U);
  EXPECT_EQ(report["left_out"]["other_parts"].size(), 60U);
  const std::string failure = "part 3 of 3 (60 points) cannot be meshed";
  EXPECT_NE(report["failures"].dump().find(failure), std::string::npos);
  EXPECT_NE(result.errors.find("warning: " + failure), std::string::npos);
  EXPECT_EQ(tool({"three.xyz", "out.ply", "-parts", "each", "-strict"}).exit_code, 1);
  ASSERT_EQ(tool({"three.xyz", "open.ply", "-parts", "each", "-surface", "open"}).exit_code, 0);
  EXPECT_EQ(mesh("open.ply").points().cols(), 560);
}

TEST_F(PartsOption, APartThatCannotBeMeshedIsNamedBesideFindingsOfOthers) {
  ASSERT_EQ(run(SCAN_TOOL, {"bowl", "bowl.xyz", "-points", "1000"}, {}).exit_code, 0);
  std::string scene = content("bowl.xyz");
  for (int i = 0; i < 400; ++i)
    scene += "9 " + std::to_string(0.05 * (i % 20)) + " " + std::to_string(0.05 * (i / 20)) + "\n";
  write("scene.xyz", scene);
  const RunResult result = tool({"scene.xyz", "out.ply", "-parts", "each"});
  EXPECT_NE(result.output.find("\nverdict   A sound mesh, but it fills 1 opening.\n"),
            std::string::npos);
  EXPECT_NE(
      result.errors.find("warning: part 2 of 2 (400 points) cannot be meshed: all points lie"),
      std::string::npos);
  EXPECT_NE(result.errors.find(": try -surface open\n"), std::string::npos);
  const RunResult strict = tool({"scene.xyz", "out.ply", "-parts", "each", "-strict"});
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_NE(strict.errors.find("surface = open; opening"), std::string::npos) << strict.errors;
}

TEST_F(PartsOption, LargestLeavesOutTheOthersInEveryTool) {
  const RunResult result =
      tool({"two.xyz", "out.ply", "-parts", "largest", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(mesh("out.ply").points(), large);
  const json report = json::parse(content("report.json"));
  EXPECT_EQ(report["vertices"], 300);
  EXPECT_EQ(report["left_out"]["other_parts"].size(), 200U);
  EXPECT_EQ(run(REMESH_TOOL, {"two.xyz", "even.ply", "-parts", "largest"}, {}).exit_code, 0);
  EXPECT_EQ(run(REMESH_TOOL, {"two.xyz", "even.ply", "-parts", "each"}, {}).exit_code, 2);
}

TEST_F(PartsOption, OfFewerPointsAreLeftOut) {
  const RunResult result = tool(
      {"three.xyz", "out.ply", "-parts", "each", "-min-points", "201", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(mesh("out.ply").points(), large);
  EXPECT_EQ(json::parse(content("report.json"))["left_out"]["other_parts"].size(), 260U);
}

TEST_F(PartsOption, MistakesEndTheToolWithoutAFile) {
  const std::vector<std::pair<Words, std::string>> mistakes = {
      {{"out.ply", "-parts", "some"}, "'some' is not allowed"},
      {{"out.ply", "-min-points", "60"}, "does nothing with -parts all"},
      {{"out.ply", "-parts", "each", "-min-points", "3"}, "-min-points"},
      {{"out_%03d.ply"}, "is a pattern for several parts"},
      {{"out.ply", "-parts", "each", "-sphere", "s.ply"}, "can hold only one part"},
      {{"out.ply", "-parts", "each", "-sphere", "s%03d.ply"}, "can hold only one part"},
      {{"out.ply", "-parts", "largest", "-min-points", "301"}, "no part has min_points = 301"},
  };
  for (const auto& [words, message] : mistakes) {
    Words arguments = {"two.xyz"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const RunResult result = tool(arguments);
    EXPECT_NE(result.exit_code, 0) << message;
    EXPECT_NE(result.errors.find(message), std::string::npos) << result.errors;
    EXPECT_FALSE(exists("out.ply")) << message;
  }
}

}  // namespace
