// pcl_spherical_param_reconstruction, run as a user does: what is written, reported and printed.

#include "helpers.h"
#include "spherical_param/self_intersection.h"
#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Positions;
using tool_test::ellipsoid;
using tool_test::expectEntries;
using tool_test::linesOf;
using tool_test::MeshFile;
using tool_test::plyOf;
using tool_test::RunOptions;
using tool_test::RunResult;
using Words = std::vector<std::string>;

/// 200 points of an ellipsoid in in.ply, with normals and colours.
class ReconstructionTool : public tool_test::ToolTest {
protected:
  void SetUp() override { write("in.ply", plyOf(points, normals, colors)); }

  RunResult tool(const Words& arguments, const RunOptions& options = {}) const {
    return run(RECONSTRUCTION_TOOL, arguments, options);
  }
  json reportOf(const Words& arguments) const {
    return ToolTest::reportOf(RECONSTRUCTION_TOOL, arguments);
  }

  const Positions points = ellipsoid(200);
  const Positions normals = ellipsoid(200, {1.0, 1.0, 1.0});
  const Positions colors = (127.0 * normals.array() + 128.0).round().matrix();
};

TEST_F(ReconstructionTool, MeshAndSphereHaveTheSameTrianglesAndKeepWhatThePointsHave) {
  expectSuccess(RECONSTRUCTION_TOOL, {"in.ply", "out.PLY", "-sphere", "sphere.ply"});
  const MeshFile out = mesh("out.PLY");
  const MeshFile sphere = mesh("sphere.ply");
  EXPECT_EQ(out.points(), points);
  EXPECT_EQ(out.normals(), normals);
  EXPECT_EQ(out.colors(), colors);
  EXPECT_TRUE(out.isSphere());
  EXPECT_GT(spherical_param::test::volumeOf(out.points(), out.triangles), 0.0);
  EXPECT_EQ(sphere.triangles, out.triangles);
  EXPECT_EQ(sphere.colors(), colors);
  EXPECT_EQ(sphere.properties.count("nx"), 0U);
  // The rounding of three floats.
  EXPECT_LT((sphere.points().colwise().norm().array() - 1.0).abs().maxCoeff(), 2e-7);
  expectSuccess(RECONSTRUCTION_TOOL, {"in.ply", "text.ply", "-ascii"});
  EXPECT_NE(content("text.ply").find("format ascii"), std::string::npos);
}

TEST_F(ReconstructionTool, WhatFurtherColumnsHoldIsSaidAndComesAlong) {
  std::string text;
  std::istringstream lines(linesOf(points));
  for (std::string line; std::getline(lines, line);)
    text += line + " " + std::to_string(text.size() % 7) + ".5 10 20 30\n";
  write("in.pts", "200\n" + text);
  const RunResult result = tool({"in.pts", "out.ply", "-verbose"});
  EXPECT_NE(result.output.find("200 points; text, 7 columns: x y z intensity red green blue, "
                               "separated by blanks\n"),
            std::string::npos);
  EXPECT_EQ(mesh("out.ply").points(), points);
  EXPECT_EQ(mesh("out.ply").properties.at("intensity")[0], 0.5);
  EXPECT_EQ(mesh("out.ply").properties.at("blue")[199], 30.0);
  EXPECT_EQ(reportOf({"in.pts", "out.ply", "-columns", "x,y,z,-,nx,ny,nz"})["options"]["columns"],
            json({"x", "y", "z", "-", "nx", "ny", "nz"}));
  EXPECT_EQ(mesh("out.ply").properties.count("red"), 0U);
  EXPECT_EQ(mesh("out.ply").properties.at("nz")[0], 30.0);
  EXPECT_NE(tool({"in.pts", "out.stl"}).output.find("out.stl (without colours)\n"),
            std::string::npos);
  expectRefused(RECONSTRUCTION_TOOL, {"in.ply", "out.stl", "-columns", "x,y,z"}, 2, "-columns");
  expectRefused(RECONSTRUCTION_TOOL, {"in.pts", "out.stl", "-columns", "x,y,q"}, 2,
                "no x, y and z");
}

TEST_F(ReconstructionTool, NormalsThatAreNullAreReplacedByThoseOfTheMesh) {
  write("in.ply", plyOf(points, Positions::Zero(3, 200)));
  expectSuccess(RECONSTRUCTION_TOOL, {"in.ply", "out.ply"});
  const Positions written = mesh("out.ply").normals();
  EXPECT_LT((written.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-6);
  EXPECT_GT(written.cwiseProduct(points).colwise().sum().minCoeff(), 0.0);
}

TEST_F(ReconstructionTool, AnOffsetIsTakenOffWhereSinglePrecisionIsTooCoarse) {
  const Eigen::Vector3d far(512345.678, 5412345.25, 301.5);
  const Positions utm = points.colwise() + far;
  write("utm.ply", plyOf(utm));
  EXPECT_EQ(reportOf({"utm.ply", "out.ply"})["offset"], json({0.0, 0.0, 0.0}));
  EXPECT_TRUE(tool_test::containsAll(mesh("out.ply").points(), utm));
  EXPECT_EQ(reportOf({"in.ply", "out.stl"})["offset"], json({0.0, 0.0, 0.0}));
  for (const char* name : {"out.stl", "out.glb"}) {
    EXPECT_EQ(reportOf({"utm.ply", name})["offset"], json({512346.0, 5412345.0, 302.0}));
    EXPECT_NE(
        tool({"utm.ply", name}).output.find(std::string(name) + " (less 512346, 5412345, 302)\n"),
        std::string::npos);
  }
  const json report = reportOf({"utm.ply", "out.ply", "-offset", "512345,5412345.25,300"});
  EXPECT_EQ(report["options"]["offset"], json({512345.0, 5412345.25, 300.0}));
  const Eigen::Vector3d offset(512345.0, 5412345.25, 300.0);
  EXPECT_LT(((mesh("out.ply").points().colwise() + offset) - utm).cwiseAbs().maxCoeff(), 1e-6);
  expectRefused(RECONSTRUCTION_TOOL, {"utm.ply", "out.stl", "-offset", "1,2"}, 2, "three numbers");
}

/// Unit spheres without caps, with these coordinates x of their centres.
Positions spheresWithoutCaps(int n, const std::vector<double>& centers) {
  std::vector<Eigen::Vector3d> kept;
  for (const double x : centers) {
    const Positions whole = ellipsoid(n, {1.0, 1.0, 1.0}, {x, 0.0, 0.0});
    std::copy_if(whole.colwise().begin(), whole.colwise().end(), std::back_inserter(kept),
                 [](const Eigen::Vector3d& point) { return std::abs(point.z()) < 0.8; });
  }
  Positions points(3, static_cast<Eigen::Index>(kept.size()));
  std::copy(kept.begin(), kept.end(), points.colwise().begin());
  return points;
}

TEST_F(ReconstructionTool, APlyFileMarksTheVerticesThatWereAddedToEachSurface) {
  const Positions given = spheresWithoutCaps(600, {0.0, 5.0});
  const Positions gray = Positions::Constant(3, given.cols(), 99.0);
  write("two.ply", plyOf(given, given, gray));
  const auto filled = [&](const std::string& output, const Words& options) {
    const Words words{"two.ply", output, "-surface", "closed", "-fill", "smooth"};
    return tool(tool_test::with(words, options));
  };
  const auto expect_marks = [&](const MeshFile& out) {
    const std::vector<double>& added = out.properties.at("added");
    EXPECT_EQ(out.colors().cols(), out.points().cols());
    for (Eigen::Index v = 0; v < out.points().cols(); ++v) {
      const bool is_given =
          (given.colwise() - out.points().col(v)).colwise().norm().minCoeff() == 0;
      EXPECT_EQ(added[static_cast<std::size_t>(v)], is_given ? 0.0 : 1.0) << v;
    }
    return std::count(added.begin(), added.end(), 1.0);
  };
  filled("out.ply", {"-json", "r.json"});
  const auto marked = expect_marks(mesh("out.ply"));
  EXPECT_GT(marked, 0);
  EXPECT_EQ(json::parse(content("r.json"))["parts"].size(), 2U);
  filled("text.ply", {"-ascii"});
  std::istringstream lines(content("text.ply"));
  Eigen::Index vertices = 0;
  for (std::string line; std::getline(lines, line);)
    vertices += line.size() > 11 && line.substr(line.size() - 11) == " 99 99 99 1" ? 1 : 0;
  EXPECT_EQ(vertices, marked) << content("text.ply").substr(0, 500);
  filled("out_%03d.ply", {});
  EXPECT_EQ(expect_marks(mesh("out_000.ply")) + expect_marks(mesh("out_001.ply")), marked);
  EXPECT_NE(filled("out.ply", {"-sphere", "s.ply"}).errors.find("give -fill flat"),
            std::string::npos);
  expectSuccess(RECONSTRUCTION_TOOL, {"two.ply", "out.ply", "-surface", "closed"});
  EXPECT_EQ(mesh("out.ply").properties.count("added"), 0U);
}

TEST_F(ReconstructionTool, DuplicatesAndPointsThatAreNotFiniteAreLeftOutAndCounted) {
  std::string text = "nan 0 0\n";
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    text += linesOf(points.col(i)) + (i % 10 == 0 ? linesOf(points.col(0)) : "");
  write("in.xyz", text + "1 inf 0\n");
  const json report = reportOf({"in.xyz", "out.ply"});
  expectEntries(report, R"({"points": 222, "left_out": {"not_finite": [0, 221]}, "duplicates": 20,
                            "vertices": 200, "findings": []})"_json);
  EXPECT_NE(tool({"in.xyz", "out.ply"})
                .output.find("\nleft out  20 duplicates, 2 points that are not finite\n"),
            std::string::npos);
  EXPECT_EQ(mesh("out.ply").points(), points);
}

TEST_F(ReconstructionTool, ATimeLimitThatEndsTheWorkIsSaid) {
  expectSuccess(SCAN_TOOL, {"ellipsoid", "in.xyz", "-points", "800", "-noise", "0.5"});
  const json limited = reportOf({"in.xyz", "out.ply", "-time-limit", "0", "-parts", "largest"});
  expectEntries(limited, {{"is_out_of_time", true}, {"options", {{"time_limit", 0.0}}}});
  EXPECT_NE(limited["findings"].dump().find("time limit"), std::string::npos);
  EXPECT_TRUE(mesh("out.ply").isSphere());
  expectEntries(reportOf({"in.xyz", "out.ply"}),
                {{"is_out_of_time", false}, {"options", {{"time_limit", nullptr}}}});
}

/// Expects the members of an example, with values of the same types; of lists the first.
void expectTypes(const json& report, const json& example, const std::string& path = "") {
  EXPECT_STREQ(report.type_name(), example.type_name()) << path;
  EXPECT_EQ(report.is_number_float(), example.is_number_float()) << path;
  if (!example.is_structured())
    return;
  for (const auto& [key, value] : example.items()) {
    const json::json_pointer member("/" + key);
    ASSERT_TRUE(report.contains(member)) << path << "/" << key;
    expectTypes(report.at(member), value, path + "/" + key);
  }
}

TEST_F(ReconstructionTool, ReportHasAllKeysWithTheirTypes) {
  const json report = reportOf({"in.ply", "out.ply", "-starts=4"});
  expectTypes(report, R"({
      "version": "", "input": "", "output": "", "offset": [0.1, 0.1, 0.1], "points": 0,
      "vertices": 0, "edges": 0, "duplicates": 0, "triangles": 0, "components": 0, "genus": 0,
      "boundary_loops": 0, "self_intersections": 0, "intersecting_triangles": 0,
      "peak_memory_bytes": 0, "usable": true, "closed": true, "manifold": true, "oriented": true,
      "is_noisy": true, "is_out_of_time": true, "verdict": "", "findings": [], "openings": [],
      "self_intersecting_pairs": [], "outliers": [], "boundary": [], "handles": [],
      "consolidation": null, "smoothing": null, "stages": [{"name": "", "seconds": 0.1}],
      "left_out": {"not_finite": [], "outliers": [], "other_parts": []},
      "embedding": {"iterations": 0, "start_level": 0, "residual": 0.1, "centroid_norm": 0.1,
                    "converged": true, "fallback_start": true, "stop_reason": "", "barrier": "",
                    "residuals": [], "levels": [{"newton_iterations": 0}]},
      "diagnosis": {"kind": "", "edges_outside_graph": 0.1, "looks_closed_genus0": true,
                    "handles": [], "bridges": []},
      "measures": {"volume": 0.1, "area": 0.1, "mean_edge_length": 0.1,
                   "box_min": [0.1, 0.1, 0.1], "box_max": [0.1, 0.1, 0.1],
                   "centroid": [0.1, 0.1, 0.1], "inertia": [[0.1], [0.1], [0.1, 0.1, 0.1]]}})"_json);
  // Steps that smooth the embedding are none to a solution.
  expectEntries(report, R"({
      "points": 200, "triangles": 396, "closed": true, "manifold": true, "oriented": true,
      "genus": 0, "diagnosis": {"kind": "closed_genus0"},
      "embedding": {"stop_reason": "unfinished"}})"_json);
  const MeshFile out = mesh("out.ply");
  EXPECT_NEAR(report["measures"]["volume"],
              spherical_param::test::volumeOf(out.points(), out.triangles), 1e-9);
}

TEST_F(ReconstructionTool, OpeningsAreReportedAndFilledIfAsked) {
  constexpr int count = 1500;  // the spiral goes from one end to the other
  write("open.ply", plyOf(ellipsoid(2000).leftCols(count)));
  const RunResult text = tool({"open.ply", "out.ply", "-json", "r.json"});
  const json open = json::parse(content("r.json"));
  expectEntries(open, {{"closed", false}, {"diagnosis", {{"kind", "open"}}}});
  EXPECT_EQ(open["openings"][0]["is_filled"], false);
  ASSERT_EQ(open["boundary"].size(), 1U);
  // V - E + F = 1.
  const auto edges = static_cast<Eigen::Index>(open["boundary"][0].size());
  EXPECT_EQ(mesh("out.ply").triangles.cols(), 2 * count - 2 - edges);
  EXPECT_NE(text.output.find("\nverdict   A sound mesh with 1 opening.\n"), std::string::npos);
  EXPECT_EQ(text.errors, "");
  const json closed = reportOf({"open.ply", "out.ply", "-fill-holes", "1000"});
  EXPECT_EQ(closed["closed"], true);
  EXPECT_EQ(closed["openings"][0]["is_filled"], true);
}

TEST_F(ReconstructionTool, ConsolidationIsReportedAndWritten) {
  write("noisy.ply", plyOf(spherical_param::test::withNoise(ellipsoid(1500), 0.01, 5)));
  const RunResult text =
      tool({"noisy.ply", "out.ply", "-consolidation", "auto", "-json", "r.json"});
  const json consolidation = json::parse(content("r.json"))["consolidation"];
  EXPECT_EQ(mesh("out.ply").points().cols(), 1500 - consolidation["merged"].get<Eigen::Index>());
  EXPECT_NEAR(consolidation["noise"], 0.01, 0.005);
  EXPECT_EQ(text.output.rfind("read      noisy.ply, 1,500 points\n", 0), 0U);
  EXPECT_NE(text.output.find("\nmoved     by 0.0"), std::string::npos);
  EXPECT_EQ(text.errors, "");
}

TEST_F(ReconstructionTool, OptionsReachTheLibraryAndThoseWithoutEffectAreNull) {
  const json paper =
      reportOf({"in.ply", "out.ply", "--method=paper", "-max-iterations=3", "-weights", "inverse"});
  const json& iteration = paper["embedding"];
  expectEntries(iteration,
                {{"iterations", 3}, {"stop_reason", "iteration_limit"}, {"levels", json::array()}});
  // A residual before each step and at the end.
  EXPECT_EQ(iteration["residuals"].size(), 4U);
  EXPECT_EQ(iteration["residuals"].back(), iteration["residual"]);
  expectEntries(paper["options"], R"({"max_iterations": 3, "weights": "inverse", "k": 25,
                                      "starts": null, "tolerance": null, "surface": null})"_json);
  const json standard = reportOf({"in.ply", "out.ply", "-starts", "5"});
  expectEntries(standard["options"], {{"starts", 5}, {"max_iterations", nullptr}, {"k", nullptr}});
  EXPECT_LT(standard["embedding"]["levels"][0]["edges"], 200 * 4);
}

TEST_F(ReconstructionTool, FindingsNamePointsOfTheInputBehindThoseLeftOut) {
  // Outliers and points that are not finite before all others shift the vertices.
  expectSuccess(SCAN_TOOL, {"bowl", "plain.xyz", "-points", "1000"});
  write("shifted.xyz", "nan 0 0\n5 5 5\n5 5 5\n" + content("plain.xyz"));
  const Words closed = {"-topology", "sphere", "-outliers", "6"};
  const json plain = reportOf(tool_test::with({"plain.xyz", "out.ply"}, closed));
  const json shifted = reportOf(tool_test::with({"shifted.xyz", "out.ply"}, closed));
  EXPECT_TRUE(plain["left_out"]["outliers"].empty());
  expectEntries(shifted, R"({"left_out": {"outliers": [1, 2], "not_finite": [0]}, "outliers": [],
                             "vertices": 1000})"_json);
  EXPECT_NE(shifted["stages"].dump().find("\"outliers\""), std::string::npos);
  EXPECT_EQ(mesh("out.ply").vertexCount(), 1000U);
  ASSERT_EQ(plain["openings"].size(), 1U);
  ASSERT_EQ(shifted["openings"].size(), 1U);
  EXPECT_EQ(plain["diagnosis"]["kind"], "open");
  EXPECT_GT(plain["openings"][0]["triangles"], 0);
  auto expected = plain["openings"][0]["loop"].get<std::vector<int>>();
  std::transform(expected.begin(), expected.end(), expected.begin(), [](int v) { return v + 3; });
  EXPECT_EQ(shifted["openings"][0]["loop"], json(expected));
  EXPECT_EQ(reportOf({"shifted.xyz", "out.ply", "-topology", "sphere"})["outliers"], json({1}));
}

TEST_F(ReconstructionTool, SelfIntersectionsOfTheReportAreThoseOfTheMesh) {
  expectSuccess(SCAN_TOOL, {"hand", "mess.ply", "-points", "1000"});
  const RunResult result =
      tool({"mess.ply", "out.ply", "-method", "paper", "-json", "report.json"});
  const json report = json::parse(content("report.json"));
  const MeshFile out = mesh("out.ply");
  auto pairs = spherical_param::findSelfIntersections(out.points(), out.triangles);
  EXPECT_EQ(report["self_intersections"], pairs.size());
  ASSERT_GT(pairs.size(), 1000U);
  pairs.resize(1000);  // no more are listed
  EXPECT_EQ(report["self_intersecting_pairs"], json(pairs));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(report["usable"], false);
  // What it encloses means nothing.
  for (const char* number : {"volume", "centroid", "inertia"})
    EXPECT_TRUE(report["measures"][number].is_null()) << number;
  EXPECT_EQ(result.output.find("centroid"), std::string::npos);
}

TEST_F(ReconstructionTool, SmoothingMovesThePointsAloneAndTellsHowFar) {
  const Positions noisy =
      spherical_param::test::withNoise(ellipsoid(1000), 0.01, 3).cast<float>().cast<double>();
  write("noisy.ply", plyOf(noisy));
  const json report = reportOf({"noisy.ply", "out.ply", "-smoothing", "3"});
  const MeshFile out = mesh("out.ply");
  const double moved = (out.points() - noisy).colwise().norm().maxCoeff();
  EXPECT_GT(moved, 0.001);
  constexpr double rounding = 1e-6;  // of single precision
  EXPECT_NEAR(report["smoothing"]["max_displacement"], moved, rounding);
  EXPECT_NEAR(report["measures"]["volume"], spherical_param::test::volumeOf(noisy, out.triangles),
              1e-9);
}

// Sanitizers take address space and memory of their own.
#ifndef SPHERICAL_PARAM_SANITIZED
// Each thread takes address space.
TEST_F(ReconstructionTool, AbsurdNumbersOfThreadsAreNotStarted) {
  write("large.xyz", linesOf(ellipsoid(20000)));
  RunOptions options;
  options.address_space_limit = std::size_t{3} << 30U;
  const RunResult result = tool({"large.xyz", "out.ply", "-threads", "1024"}, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_TRUE(exists("out.ply"));
}

TEST_F(ReconstructionTool, ReportedMemoryIsThatOfTheToolAlone) {
  // What the process that starts the tool has in use is no part of it.
  const std::vector<char> large(100U << 20U, 'x');
  ASSERT_EQ(large.back(), 'x');
  EXPECT_LT(reportOf({"in.ply", "out.ply"})["peak_memory_bytes"], 60 << 20);
}

TEST_F(ReconstructionTool, TakesLessThanOneKilobyteAPoint) {
  const auto peak = [&](int n) {
    write("many.xyz", linesOf(ellipsoid(n)));
    return reportOf({"many.xyz", "out.ply"})["peak_memory_bytes"].get<double>();
  };
  constexpr int many = 30000;
  EXPECT_LT((peak(many) - peak(200)) / many, 1024.0);
}
#endif

TEST_F(ReconstructionTool, PrintsSixLinesAndWarningsApart) {
  write("noisy.xyz", "nan 0 0\n9 9 9\n" + linesOf(points));
  const RunResult clean = tool({"noisy.xyz", "out.ply"});
  EXPECT_EQ(clean.errors, "");
  EXPECT_EQ(std::count(clean.output.begin(), clean.output.end(), '\n'), 6);
  EXPECT_EQ(clean.output.rfind("read      noisy.xyz, 202 points\n"
                               "verdict   A sound mesh; 1 stray point left out.\n"
                               "made      200 vertices, 396 triangles\n"
                               "time      ",
                               0),
            0U)
      << clean.output;
  EXPECT_NE(clean.output.find("\nleft out  1 point that is not finite, 1 stray point\n"
                              "written   out.ply\n"),
            std::string::npos);
  for (const Words& words : {Words{}, Words{"-json", "-"}}) {
    EXPECT_EQ(tool(tool_test::with({"noisy.xyz", "out.ply", "-topology", "sphere"}, words)).errors,
              "warning: 1 stray point in the mesh: try -topology scan\n");
  }
  EXPECT_EQ(tool({"noisy.xyz", "out.ply", "-quiet"}).errors, "");
}

TEST_F(ReconstructionTool, VerbosePrintsOptionsStagesAndTables) {
  const RunResult result = tool({"in.ply", "out.ply", "-smoothing", "3", "-verbose"});
  EXPECT_EQ(result.output.find_first_of("\r\033"), std::string::npos);
  for (const char* line : {"\n  method              default\n", "\n  embedding  ", "\n  write  ",
                           "\n  nodes  edges  sweeps ", "\n  volume  ", "\n  centroid  ",
                           "\nverdict   A sound mesh.\n"})
    EXPECT_NE(result.output.find(line), std::string::npos) << line;
}

TEST_F(ReconstructionTool, EachFindingIsACommandThatHelps) {
  expectSuccess(SCAN_TOOL, {"pair", "pair.ply", "-points", "1000"});
  expectSuccess(SCAN_TOOL, {"bowl", "bowl.ply", "-points", "2000"});
  write("stray.xyz", "9 9 9\n" + linesOf(ellipsoid(800)));
  for (const char* input : {"pair.ply", "bowl.ply", "stray.xyz"}) {
    const RunResult result = tool({input, "out.ply", "-topology", "sphere"});
    const std::size_t place = result.errors.find(": try -");
    ASSERT_NE(place, std::string::npos) << result.errors;
    std::istringstream words(result.errors.substr(place + 6));
    std::string option;
    std::string value;
    words >> option >> value;
    const RunResult better = tool({input, "out.ply", option, value, "-strict"});
    EXPECT_EQ(better.exit_code, 0) << input << " " << option << " " << value;
    EXPECT_EQ(better.errors, "");
  }
}

TEST_F(ReconstructionTool, ATerminalShowsABarOfWhatTakesLong) {
  expectSuccess(SCAN_TOOL, {"ellipsoid", "in.ply", "-points", "1000"});
  RunOptions options;
  options.terminal = true;
  // Some seconds of work on any machine.
  const RunResult result = tool(
      {"in.ply", "out.ply", "-method", "paper", "-tolerance", "0", "-max-iterations", "100000"},
      options);
  EXPECT_NE(result.output.find("\r  embedding           ["), std::string::npos);
  // It does not stay.
  EXPECT_NE(result.output.find("\r\033[Kread"), std::string::npos);
}

}  // namespace
