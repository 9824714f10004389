// What all tools promise: help, silence, reports, the same bytes, and nothing half done.

#include "open_shapes.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/option_table.h"
#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <string>
#include <vector>

namespace {

using nlohmann::json;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::with;
using Words = std::vector<std::string>;

/// A tool that takes the options of the reconstruction, with a run of it that writes all it can.
struct Tool {
  std::string name;
  std::string program;
  Words arguments;
  Words further_options;  ///< besides those of the table
  std::string stages;     ///< the last ones of its report
};

std::vector<Tool> meshingTools() {
  return {{"reconstruction",
           RECONSTRUCTION_TOOL,
           {"in.ply", "out.ply", "-sphere", "s.vtk", "-smoothing", "4", "-outliers", "5"},
           {"outliers", "sphere", "report", "json", "ascii", "strict", "quiet"},
           "optimization smoothing quality write "},
          {"remesh",
           REMESH_TOOL,
           {"in.ply", "out.ply", "-sphere", "s.ply", "-harmonics", "c.json", "-degree", "6"},
           {"grid", "points", "side", "fit", "sphere", "harmonics", "series", "degree",
            "area-weight", "map-sweeps", "outliers", "json", "ascii", "strict", "quiet"},
           "map surface harmonics resample untangle verify write "},
          {"texture",
           TEXTURE_TOOL,
           {"in.ply", "out.obj", "-size", "64", "-chart", "cube"},
           {"chart", "size", "gutter", "checker", "image", "area-weight", "map-sweeps", "outliers",
            "json", "ascii", "strict", "quiet"},
           "quality map atlas image write "},
          {"morph",
           MORPH_TOOL,
           {"in.ply", "other.ply", "out.ply", "-frames", "3", "-pairs", "pairs.txt"},
           {"frames", "pairs", "align", "connectivity", "samples", "fit", "match", "check",
            "area-weight", "map-sweeps", "outliers", "json", "ascii", "strict", "quiet"},
           "write "}};
}

/// The names of all options as in the report; -report alone sets those of the history.
Words optionsOf(const Tool& tool) {
  Words options = tool.further_options;
  for (const spherical_param::OptionRow& row : spherical_param::optionTable())
    if (row.name.rfind("history", 0) != 0)
      options.push_back(row.name);
  for (std::string& option : options)
    std::replace(option.begin(), option.end(), '-', '_');
  return options;
}

class EveryTool : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("in.ply", cloud(300));
    write("other.ply", cloud(250));
    write("pairs.txt", "3 5\n290 240\n");
  }

  static std::string cloud(int points) {
    const spherical_param::Positions surface = tool_test::ellipsoid(points);
    return tool_test::plyOf(surface, {}, (100.0 * surface.array().abs() + 20.0).round().matrix());
  }
};

TEST_F(EveryTool, HelpListsEveryOptionAndHelpAndVersionSucceed) {
  for (const Tool& tool : meshingTools()) {
    SCOPED_TRACE(tool.name);
    const RunResult help = expectSuccess(tool.program, {"-h", "expert"});
    for (std::string option : optionsOf(tool)) {
      std::replace(option.begin(), option.end(), '_', '-');
      EXPECT_NE(help.output.find("\n  -" + option + " "), std::string::npos) << option;
    }
    EXPECT_EQ(help.output.find("-history"), std::string::npos);
    const RunResult version = expectSuccess(tool.program, {"--version"});
    EXPECT_EQ(version.output.rfind("pcl_spherical_param_" + tool.name + " ", 0), 0U);
  }
}

TEST_F(EveryTool, ReportIsAloneOnStandardOutputAndHasEveryOption) {
  for (const Tool& tool : meshingTools()) {
    SCOPED_TRACE(tool.name);
    const json report = reportOf(
        tool.program, with(tool.arguments, {"-seed", "7", "-starts", "9", "-threads", "2"}));
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["options"]["seed"], 7);
    EXPECT_EQ(report["options"]["starts"], 9);
    EXPECT_EQ(report["options"]["threads"], 2);
    EXPECT_TRUE(report["options"]["tolerance"].is_null());
    for (const std::string& option : optionsOf(tool))
      EXPECT_TRUE(report["options"].contains(option)) << option;
    EXPECT_TRUE(report["version"].is_string());
    std::string stages;
    for (const json& stage : report["stages"]) {
      EXPECT_GE(stage["seconds"], 0.0);
      stages += stage["name"].get<std::string>() + " ";
    }
    EXPECT_NE(stages.find(tool.stages), std::string::npos) << stages;
    if (tool.name == "reconstruction")
      continue;
    const json& map = tool.name == "morph" ? report["first"] : report;
    EXPECT_EQ(map["flipped_triangles"], 0);
    for (const char* kind : {"angle_distortion", "area_distortion"}) {
      EXPECT_GE(map[kind]["mean"], 1.0);
      EXPECT_GE(map[kind]["p95"], map[kind]["mean"]);
      EXPECT_GE(map[kind]["max"], map[kind]["p95"]);
    }
  }
}

TEST_F(EveryTool, QuietPrintsNothingAndWritesTheSameBytesByAnyNumberOfThreads) {
  for (const Tool& tool : meshingTools()) {
    SCOPED_TRACE(tool.name);
    std::map<std::string, std::string> first;
    for (const char* threads : {"1", "3"}) {
      const RunResult result =
          expectSuccess(tool.program, with(tool.arguments, {"-quiet", "-threads", threads}));
      EXPECT_EQ(result.output + result.errors, "");
      EXPECT_TRUE(exists(tool.name == "morph" ? "out_002.ply" : tool.arguments[1]));
      const auto files = directory.listing();
      if (first.empty())
        first = files;
      EXPECT_TRUE(files == first) << threads;
    }
  }
}

TEST_F(EveryTool, StrictMakesFaultsAFailureAndWritesTheFiles) {
  expectSuccess(SCAN_TOOL, {"bowl", "in.ply", "-points", "500"});
  for (const Tool& tool : meshingTools()) {
    SCOPED_TRACE(tool.name);
    EXPECT_EQ(
        expectSuccess(tool.program, with(tool.arguments, {"-topology", "sphere", "-quiet"})).errors,
        "");
    const auto files = directory.listing();
    const RunResult strict =
        run(tool.program,
            with(tool.arguments, {"-topology", "sphere", "-strict", "-quiet", "-json", "-"}));
    EXPECT_EQ(strict.exit_code, 1);
    const std::vector<std::string> lines = strict.errorLines();
    ASSERT_EQ(lines.size(), 2U) << strict.errors;
    EXPECT_EQ(lines[1].rfind("  remedy: the files were written", 0), 0U) << lines[1];
    EXPECT_TRUE(directory.listing() == files);
    const json report = json::parse(strict.output);
    EXPECT_EQ(report["options"]["strict"], true);
    // Morphing has findings of each object.
    const json& findings = (tool.name == "morph" ? report["first"] : report)["findings"];
    EXPECT_FALSE(findings.empty());
    for (const json& finding : findings)
      if (finding["is_fault"] == true) {
        EXPECT_NE(lines[0].find(finding["text"].get<std::string>()), std::string::npos) << finding;
      }
  }
  // Where there is none, nothing changes.
  expectSuccess(RECONSTRUCTION_TOOL, {"other.ply", "out.ply", "-strict", "-quiet"});
}

TEST_F(EveryTool, OpenSurfacesStayOpen) {
  write("open.xyz", tool_test::linesOf(spherical_param::test::hemisphere(1000)));
  const Words open = {"-surface", "open", "-quiet"};
  const auto mesh_of = [&](const std::string& tool, const Words& words, const std::string& output) {
    expectSuccess(tool, with(words, open));
    // Without vertices where the opening is.
    EXPECT_LT(mesh(output).points().row(2).maxCoeff(), 0.05) << output;
    return mesh(output);
  };
  // Vertices on the cuts of the chart are there once for each side.
  mesh_of(TEXTURE_TOOL, {"open.xyz", "texture.ply", "-checker", "8"}, "texture.ply");
  mesh_of(REMESH_TOOL, {"open.xyz", "even.ply", "-grid", "even"}, "even.ply");
  for (const tool_test::MeshFile& file :
       {mesh_of(RECONSTRUCTION_TOOL, {"open.xyz", "mesh.ply"}, "mesh.ply"),
        mesh_of(REMESH_TOOL, {"open.xyz", "grid.ply", "-points", "2000"}, "grid.ply"),
        mesh_of(MORPH_TOOL, {"open.xyz", "in.ply", "m.ply", "-frames", "2"}, "m_000.ply")}) {
    const auto topology = spherical_param::checkTopology(file.triangles, file.vertexCount());
    EXPECT_TRUE(topology.isOpenSurface());
    EXPECT_EQ(topology.euler_characteristic, 1);
  }
}

TEST_F(EveryTool, ASignalLeavesNothingBehindAndKeepsTheOldFile) {
  // The tool waits for a reader of the pipe, with the mesh in a temporary file.
  ASSERT_EQ(mkfifo(directory.file("pipe.ply").c_str(), 0600), 0);
  write("out.ply", "kept");
  const auto before = directory.listing();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
    SCOPED_TRACE(signal);
    RunOptions options;
    options.signal_when_temporary = signal;
    options.time_limit = 20;
    const RunResult result =
        run(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-sphere", "pipe.ply"}, options);
    EXPECT_EQ(result.signal, signal);
    if (signal != SIGKILL) {
      EXPECT_TRUE(directory.listing() == before);
    }
    EXPECT_EQ(content("out.ply"), "kept");
  }
}

}  // namespace
