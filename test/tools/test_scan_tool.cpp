// pcl_spherical_param_scan, run as a user does.

#include "scan_shapes.h"
#include "tool_test.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace {

using tool_test::RunResult;

class ScanTool : public tool_test::ToolTest {
protected:
  RunResult scan(const std::vector<std::string>& arguments) const {
    return run(SCAN_TOOL, arguments);
  }
};

TEST_F(ScanTool, WritesTheScanAndItsNormalsOnRequestInEveryFormat) {
  const spherical_param::tools::ScanOptions options = {"ellipsoid", 100, 0.25, 7};
  const spherical_param::Positions points =
      spherical_param::tools::generateScan(options).points.cast<float>().cast<double>();
  const std::vector<std::string> words = {"-points=100", "-noise", "0.25", "--seed", "7"};
  const auto with = [&](std::vector<std::string> files) {
    files.insert(files.end(), words.begin(), words.end());
    return files;
  };
  ASSERT_EQ(scan(with({"out.ply", "ELLIPSOID"})).exit_code, 0);
  EXPECT_EQ(mesh("out.ply").points(), points);
  EXPECT_EQ(mesh("out.ply").properties.count("nx"), 0U);
  for (const std::string extension : {"pcd", "ply", "obj", "xyz", "txt"}) {
    const std::string name = "out." + extension;
    ASSERT_EQ(scan(with({"ellipsoid", name, "-normals"})).exit_code, 0) << name;
    const RunResult result = run(RECONSTRUCTION_TOOL, {name, extension + ".off"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    // Nothing of points and normals is lost on the way, hence all meshes are the same.
    EXPECT_EQ(content(extension + ".off").rfind("NOFF\n100 196 0\n", 0), 0U) << name;
    EXPECT_EQ(content(extension + ".off"), content("pcd.off")) << name;
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
  for (const auto& shape : spherical_param::tools::allShapes())
    EXPECT_NE(list.output.find("\n  " + shape.name), std::string::npos) << shape.name;
  // The sizes of Table 1 of the paper.
  for (const char* size : {"19818", "52809", "134345"})
    EXPECT_NE(list.output.find(size), std::string::npos) << size;
  for (const char* option : {"-h", "-version"}) {
    const RunResult result = scan({option});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.output.find("pcl_spherical_param_scan"), std::string::npos);
  }
}

}  // namespace
