// pcl_spherical_param_scan, run as a user does.

#include "tool_runner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace {

using tool_test::readFile;
using tool_test::run;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;

class ScanTool : public testing::Test {
protected:
  RunResult scan(const std::vector<std::string>& arguments) const {
    RunOptions options;
    options.directory = directory.path();
    return run(SCAN_TOOL, arguments, options);
  }

  /// The lines of a text file as numbers.
  std::vector<std::vector<double>> rows(const std::string& name) const {
    std::vector<std::vector<double>> result;
    std::istringstream file(readFile(directory.file(name)));
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      result.emplace_back();
      for (double value = 0.0; words >> value;) {
        result.back().push_back(value);
      }
    }
    return result;
  }

  std::string content(const std::string& name) const { return readFile(directory.file(name)); }

  const TemporaryDirectory directory;
};

TEST_F(ScanTool, EveryFormatOfCloudsIsReadByTheReconstructionTool) {
  for (const std::string extension : {"pcd", "ply", "obj", "xyz", "txt"}) {
    const std::string name = "out." + extension;
    ASSERT_EQ(scan({"ellipsoid", name, "-points", "300", "-normals"}).exit_code, 0) << name;
    RunOptions options;
    options.directory = directory.path();
    const RunResult result = run(RECONSTRUCTION_TOOL, {name, extension + ".off"}, options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    // Nothing of points and normals is lost on the way, hence all meshes are the same.
    EXPECT_EQ(content(extension + ".off").rfind("NOFF\n300 596 0\n", 0), 0U) << name;
    EXPECT_EQ(content(extension + ".off"), content("pcd.off")) << name;
  }
}

TEST_F(ScanTool, NormalsAreWrittenOnRequestOnly) {
  ASSERT_EQ(scan({"sphere", "a.xyz", "-points", "50"}).exit_code, 0);
  ASSERT_EQ(scan({"sphere", "b.xyz", "-points", "50", "-normals"}).exit_code, 0);
  for (const auto& row : rows("a.xyz")) {
    EXPECT_EQ(row.size(), 3U);
  }
  for (const auto& row : rows("b.xyz")) {
    ASSERT_EQ(row.size(), 6U);
    EXPECT_NEAR(std::hypot(row[3], row[4], row[5]), 1.0, 1e-6);
  }
}

TEST_F(ScanTool, TheSeedDecides) {
  ASSERT_EQ(scan({"head", "a.pcd", "-points", "200", "-seed", "7"}).exit_code, 0);
  ASSERT_EQ(scan({"head", "-seed=7", "b.pcd", "--points=200"}).exit_code, 0);
  ASSERT_EQ(scan({"head", "c.pcd", "-points", "200", "-seed", "8"}).exit_code, 0);
  EXPECT_EQ(content("a.pcd"), content("b.pcd"));
  EXPECT_NE(content("a.pcd"), content("c.pcd"));
}

TEST_F(ScanTool, TheTruthIsAClosedMesh) {
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

TEST_F(ScanTool, OutputIsToldByItsExtension) {
  EXPECT_EQ(scan({"out.ply", "SPHERE", "-points", "50"}).exit_code, 0);
  EXPECT_EQ(directory.listing().count("out.ply"), 1U);
}

TEST_F(ScanTool, ListNamesAllShapesAndPresets) {
  const RunResult result = scan({"-list"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* name :
       {"sphere", "ellipsoid", "head", "bird", "hand", "animal", "dumbbell", "star", "snake",
        "plate", "torus", "bowl", "pair", "tweety", "max", "igea"}) {
    EXPECT_NE(result.output.find(std::string("\n  ") + name + " "), std::string::npos) << name;
  }
}

TEST_F(ScanTool, HelpAndVersionSucceed) {
  for (const char* option : {"-h", "--help", "-version"}) {
    const RunResult result = scan({option});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.output.find("pcl_spherical_param_scan"), std::string::npos);
  }
}

}  // namespace
