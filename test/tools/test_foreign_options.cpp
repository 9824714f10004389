// Command lines of PCL's own tools, with the program's name changed.

#include "tool_runner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace {

using tool_test::readFile;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

/// A cloud with normals, as both tools of PCL want it.
std::string cloudWithNormals(int count) {
  std::ostringstream text;
  text << "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\n"
          "FIELDS x y z normal_x normal_y normal_z curvature\nSIZE 4 4 4 4 4 4 4\n"
          "TYPE F F F F F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH "
       << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA ascii\n";
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const double x = radius * std::cos(angle);
    const double y = radius * std::sin(angle);
    text << x << ' ' << y << ' ' << z << ' ' << x << ' ' << y << ' ' << z << " 0\n";
  }
  return text.str();
}

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

RunResult runLine(const TemporaryDirectory& directory, const std::string& line) {
  writeFile(directory.file("input.pcd"), cloudWithNormals(400));
  RunOptions options;
  options.directory = directory.path();
  return tool_test::run(RECONSTRUCTION_TOOL, wordsOf(line), options);
}

struct Line {
  const char* line;
  std::vector<const char*> noted;  ///< options that the user is told about
};

/// From the tools' help, and as people write them.
const std::vector<Line> accepted_lines = {
    {"input.pcd output.vtk", {}},
    {"input.pcd output.vtk -radius 0.025 -mu 2.5", {"-radius", "-mu"}},
    {"input.pcd output.vtk -radius 0.000000 -mu 0.000000", {"-radius", "-mu"}},
    {"-radius 0.1 input.pcd -mu 3 output.vtk", {"-radius", "-mu"}},
    {"input.pcd output.vtk -depth 8 -solver_divide 8 -iso_divide 8 -point_weight 4.000000",
     {"-depth", "-solver_divide", "-iso_divide", "-point_weight"}},
    {"input.pcd output.vtk -point_weight 0", {"-point_weight"}},
    {"-depth 10 -solver_divide 6 input.pcd output.vtk", {"-depth", "-solver_divide"}},
};

TEST(ForeignOptions, CommandLinesOfPclToolsAreTakenAndSayWhatHasNoEffect) {
  const TemporaryDirectory plain;
  ASSERT_EQ(runLine(plain, "input.pcd output.vtk").exit_code, 0);
  const std::string mesh = readFile(plain.file("output.vtk"));
  ASSERT_FALSE(mesh.empty());
  for (const Line& line : accepted_lines) {
    const TemporaryDirectory directory;
    const RunResult result = runLine(directory, line.line);
    EXPECT_EQ(result.exit_code, 0) << line.line << "\n" << result.errors;
    EXPECT_EQ(readFile(directory.file("output.vtk")), mesh) << line.line;
    std::size_t notes = 0;
    std::istringstream output(result.output);
    for (std::string text; std::getline(output, text);) {
      notes += text.find(" has no effect: ") != std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(notes, line.noted.size()) << line.line;
    for (const char* option : line.noted) {
      EXPECT_NE(result.output.find(std::string(option) + " of pcl_"), std::string::npos)
          << line.line;
    }
  }
}

TEST(ForeignOptions, TheInputMayComeLastWhereOnlyItCanBeRead) {
  const TemporaryDirectory directory;
  const RunResult result = runLine(directory, "-radius 0.1 output.vtk input.pcd");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string mesh = readFile(directory.file("output.vtk"));
  EXPECT_FALSE(mesh.empty());
  // What is there may be a scan.
  const RunResult again = runLine(directory, "output.vtk input.pcd");
  EXPECT_EQ(again.exit_code, 2);
  ASSERT_EQ(again.errorLines().size(), 2U) << again.errors;
  EXPECT_NE(again.errorLines()[1].find("put the input first"), std::string::npos);
  EXPECT_EQ(readFile(directory.file("output.vtk")), mesh);
  EXPECT_EQ(runLine(directory, "new.ply missing.pcd").exit_code, 2);
}

TEST(ForeignOptions, WhatCannotBeHadIsRefusedWithARemedy) {
  for (const std::string option : {"-grid_res 50", "-iso_level 0", "-hoppe 0", "-rbf 0",
                                   "-extend 0.1", "-displacement 0.01"}) {
    const TemporaryDirectory directory;
    const RunResult result = runLine(directory, "input.pcd output.vtk " + option);
    EXPECT_EQ(result.exit_code, 2) << option;
    const std::vector<std::string> lines = result.errorLines();
    ASSERT_EQ(lines.size(), 2U) << option;
    EXPECT_NE(lines[0].find("pcl_marching_cubes_reconstruction"), std::string::npos) << lines[0];
    EXPECT_NE(lines[1].find("leave it out"), std::string::npos) << lines[1];
    EXPECT_EQ(directory.listing().size(), 1U) << option;
  }
}

TEST(ForeignOptions, TheirValuesAreNumbersAllTheSame) {
  for (const std::string line : {"input.pcd output.vtk -radius abc", "input.pcd output.vtk -depth",
                                 "input.pcd -mu output.vtk"}) {
    const TemporaryDirectory directory;
    const RunResult result = runLine(directory, line);
    EXPECT_EQ(result.exit_code, 2) << line;
    EXPECT_EQ(result.errorLines().size(), 2U) << result.errors;
    EXPECT_EQ(directory.listing().size(), 1U) << line;
  }
}

TEST(ForeignOptions, NoHelpShowsThem) {
  const TemporaryDirectory directory;
  const RunResult result = runLine(directory, "-h");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output.find("point_weight"), std::string::npos);
  EXPECT_EQ(result.output.find("grid_res"), std::string::npos);
}

}  // namespace
