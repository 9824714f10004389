// pcl_spherical_param_scan, run as a user does.

#include "scan_shapes.h"
#include "tool_test.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace {

using tool_test::RunResult;
using Words = std::vector<std::string>;

class ScanTool : public tool_test::ToolTest {
protected:
  RunResult scan(const Words& words) const { return run(SCAN_TOOL, words); }
};

TEST_F(ScanTool, WritesTheScanAndItsNormalsOnRequestInEveryFormat) {
  const spherical_param::Positions points =
      spherical_param::tools::generateScan({"ellipsoid", 100, 0.25, 7}).points;
  Words words = {"out.ply", "ELLIPSOID", "-points=100", "-noise", "0.25", "--seed", "7"};
  ASSERT_EQ(scan(words).exit_code, 0);
  EXPECT_EQ(mesh("out.ply").points(), points.cast<float>().cast<double>());
  EXPECT_EQ(mesh("out.ply").properties.count("nx"), 0U);
  words.emplace_back("-normals");
  for (const std::string extension : {"pcd", "ply", "obj", "xyz", "txt"}) {
    words[0] = "out." + extension;
    ASSERT_EQ(scan(words).exit_code, 0) << extension;
    const RunResult result = run(RECONSTRUCTION_TOOL, {words[0], extension + ".off"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    // Nothing of points and normals is lost on the way, hence all meshes are the same.
    EXPECT_EQ(content(extension + ".off").rfind("NOFF\n100 196 0\n", 0), 0U) << extension;
    EXPECT_EQ(content(extension + ".off"), content("pcd.off")) << extension;
  }
}

TEST_F(ScanTool, TheTruthIsAFineClosedMesh) {
  ASSERT_EQ(scan({"star", "out.pcd", "-points", "100", "-truth", "truth.off"}).exit_code, 0);
  std::istringstream file(content("truth.off"));
  std::string keyword;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  file >> keyword >> vertices >> triangles;
  EXPECT_EQ(keyword, "OFF");
  EXPECT_GT(triangles, 50000U);
  EXPECT_EQ(triangles, 2 * vertices - 4);
}

TEST_F(ScanTool, ListHelpAndVersionSucceed) {
  const RunResult list = scan({"-list"});
  EXPECT_EQ(list.exit_code, 0);
  Words expected = {"19818", "52809", "134345"};  // the sizes of Table 1 of the paper
  for (const spherical_param::tools::Shape& shape : spherical_param::tools::allShapes())
    expected.push_back("\n  " + shape.name);
  for (const std::string& text : expected)
    EXPECT_NE(list.output.find(text), std::string::npos) << text;
  for (const char* option : {"-h", "-version"}) {
    const RunResult result = scan({option});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.output.find("pcl_spherical_param_scan"), std::string::npos);
  }
}

}  // namespace
