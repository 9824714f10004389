// pcl_spherical_param_reconstruction, run as a user does: what is written, reported and printed.

#include "helpers.h"
#include "spherical_param/self_intersection.h"
#include "tool_test.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using nlohmann::json;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::Triangles;
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

std::vector<std::array<Index, 2>> selfIntersections(const Positions& points,
                                                    const Triangles& triangles) {
  return spherical_param::findSelfIntersections(points, triangles);
}

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

TEST_F(ReconstructionTool, SmoothFillsAddVerticesWithColoursAtTheEnd) {
  const Positions open = spheresWithoutCaps(2000, {0.0});
  write("open.ply", plyOf(open, open, (127.0 * open.array() + 128.0).round().matrix()));
  const Words closed{"open.ply", "out.ply", "-surface", "closed", "-fill", "smooth"};
  const json report = reportOf(closed);
  const MeshFile out = mesh("out.ply");
  const Eigen::Index added = out.points().cols() - open.cols();
  EXPECT_GT(added, 0);
  EXPECT_EQ(report["added_vertices"], added);
  EXPECT_EQ(out.points().leftCols(open.cols()), open);
  EXPECT_EQ(out.colors().cols(), out.points().cols());
  EXPECT_TRUE(out.isSphere());
  EXPECT_LT((out.points().colwise().norm().array() - 1.0).abs().maxCoeff(), 0.05);
  EXPECT_TRUE(selfIntersections(out.points(), out.triangles).empty());
  Words with_sphere = closed;
  with_sphere.insert(with_sphere.end(), {"-sphere", "sphere.ply"});
  const RunResult refused = tool(with_sphere);
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.errors.find("give -fill flat"), std::string::npos);
}

TEST_F(ReconstructionTool, APlyFileMarksTheVerticesThatWereAddedToEachSurface) {
  const Positions given = spheresWithoutCaps(600, {0.0, 5.0});
  write("two.ply", plyOf(given, given, given * 0.0));
  const Words smooth{"two.ply", "out.ply", "-surface", "closed", "-fill", "smooth"};
  const auto expect_marks = [&](const MeshFile& out) {
    const std::vector<double>& added = out.properties.at("added");
    for (Eigen::Index v = 0; v < out.points().cols(); ++v) {
      const bool is_given =
          (given.colwise() - out.points().col(v)).colwise().norm().minCoeff() == 0;
      EXPECT_EQ(added[static_cast<std::size_t>(v)], is_given ? 0.0 : 1.0) << v;
    }
    return std::count(added.begin(), added.end(), 1.0);
  };
  expectSuccess(RECONSTRUCTION_TOOL, smooth);
  const auto marked = expect_marks(mesh("out.ply"));
  EXPECT_GT(marked, 0);
  Words ascii = smooth;
  ascii.push_back("-ascii");
  expectSuccess(RECONSTRUCTION_TOOL, ascii);
  EXPECT_NE(content("out.ply").find("\nproperty uchar added\n"), std::string::npos);
  std::istringstream lines(content("out.ply"));
  Eigen::Index vertices = 0;
  for (std::string line; std::getline(lines, line);)
    vertices += line.size() > 8 && line.substr(line.size() - 8) == " 0 0 0 1" ? 1 : 0;
  EXPECT_EQ(vertices, marked);
  Words numbered = smooth;
  numbered[1] = "out_%03d.ply";
  expectSuccess(RECONSTRUCTION_TOOL, numbered);
  EXPECT_EQ(expect_marks(mesh("out_000.ply")) + expect_marks(mesh("out_001.ply")), marked);
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
  const json limited = reportOf({"in.xyz", "out.ply", "-time-limit", "0"});
  EXPECT_EQ(limited["is_out_of_time"], true);
  EXPECT_NE(limited["findings"].dump().find("time limit"), std::string::npos);
  EXPECT_TRUE(mesh("out.ply").isSphere());
  EXPECT_EQ(limited["options"]["time_limit"], 0.0);
  const json parts = reportOf({"in.xyz", "out.ply", "-time-limit", "0", "-parts", "largest"});
  EXPECT_EQ(parts["is_out_of_time"], true);
  const json free = reportOf({"in.xyz", "out.ply"});
  EXPECT_EQ(free["is_out_of_time"], false);
  EXPECT_TRUE(free["options"]["time_limit"].is_null());
}

TEST_F(ReconstructionTool, ReportHasAllKeysWithTheirTypes) {
  const std::vector<std::pair<std::string, std::string>> keys = {
      {"number_integer",
       "/points /vertices /edges /duplicates /triangles /components /genus /embedding/iterations "
       "/peak_memory_bytes /self_intersections /intersecting_triangles "
       "/embedding/levels/0/newton_iterations /embedding/start_level /boundary_loops"},
      {"number_float",
       "/embedding/residual /diagnosis/edges_outside_graph /stages/0/seconds "
       "/embedding/centroid_norm /measures/volume /measures/area /measures/mean_edge_length "
       "/measures/box_min/2 /measures/box_max/2 /measures/centroid/2 /measures/inertia/2/2"},
      {"boolean",
       "/usable /closed /manifold /oriented /is_noisy /is_out_of_time /embedding/converged "
       "/embedding/fallback_start /diagnosis/looks_closed_genus0"},
      {"string", "/input /output /version /stages/0/name /embedding/stop_reason /embedding/barrier "
                 "/verdict /diagnosis/kind"},
      {"array",
       "/stages /findings /self_intersecting_pairs /embedding/residuals /embedding/levels "
       "/diagnosis/handles /diagnosis/bridges /outliers /openings /boundary /left_out/not_finite "
       "/left_out/outliers /left_out/other_parts /handles"},
      {"null", "/consolidation /smoothing"}};
  const std::map<std::string, bool (json::*)() const noexcept> is_of_type = {
      {"number_integer", &json::is_number_integer},
      {"number_float", &json::is_number_float},
      {"boolean", &json::is_boolean},
      {"string", &json::is_string},
      {"array", &json::is_array},
      {"null", &json::is_null}};
  const json report = reportOf({"in.ply", "out.ply", "-starts=4"});
  for (const auto& [type, paths] : keys) {
    std::istringstream words(paths);
    for (std::string path; words >> path;) {
      const json::json_pointer pointer(path);
      EXPECT_TRUE(report.contains(pointer) && (report.at(pointer).*is_of_type.at(type))())
          << path << " " << type;
    }
  }
  // Steps that smooth the embedding are none to a solution.
  expectEntries(report, R"({
      "points": 200, "triangles": 396, "closed": true, "manifold": true, "oriented": true,
      "genus": 0, "diagnosis": {"kind": "closed_genus0"},
      "embedding": {"stop_reason": "unfinished"}})"_json);
  const MeshFile out = mesh("out.ply");
  EXPECT_NEAR(report["measures"]["volume"],
              spherical_param::test::volumeOf(out.points(), out.triangles), 1e-9);
}

TEST_F(ReconstructionTool, OpenSurfacesAreLeftOpenIfAsked) {
  constexpr int count = 1500;  // the spiral goes from one end to the other
  write("open.ply", plyOf(ellipsoid(2000).leftCols(count)));
  const json open = reportOf({"open.ply", "out.ply"});
  expectEntries(open, {{"closed", false}, {"diagnosis", {{"kind", "open"}}}});
  EXPECT_EQ(open["openings"][0]["is_filled"], false);
  ASSERT_EQ(open["boundary"].size(), 1U);
  // V - E + F = 1.
  const auto edges = static_cast<Eigen::Index>(open["boundary"][0].size());
  EXPECT_EQ(mesh("out.ply").triangles.cols(), 2 * count - 2 - edges);
  const RunResult text = tool({"open.ply", "out.ply"});
  EXPECT_NE(text.output.find("\nverdict   A sound mesh with 1 opening.\n"), std::string::npos);
  EXPECT_EQ(text.errors, "");
  for (const Words& words : {Words{"open.ply", "out.ply", "-topology", "sphere"},
                             Words{"open.ply", "out.ply", "-fill-holes", "1000"}}) {
    const json closed = reportOf(words);
    EXPECT_EQ(closed["closed"], true);
    EXPECT_EQ(closed["openings"][0]["is_filled"], true);
  }
}

TEST_F(ReconstructionTool, ConsolidationIsReportedAndWritten) {
  const Positions noisy = spherical_param::test::withNoise(ellipsoid(1500), 0.01, 5);
  write("noisy.ply", plyOf(noisy));
  const json report = reportOf({"noisy.ply", "out.ply", "-consolidation", "auto"});
  const json& consolidation = report["consolidation"];
  const auto merged = consolidation["merged"].get<Eigen::Index>();
  const MeshFile out = mesh("out.ply");
  EXPECT_EQ(out.points().cols(), 1500 - merged);
  EXPECT_NEAR(consolidation["noise"], 0.01, 0.005);
  EXPECT_GT(consolidation["max_displacement"], consolidation["mean_displacement"]);
  const RunResult text = tool({"noisy.ply", "out.ply", "-consolidation", "auto"});
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
  const auto pairs = selfIntersections(out.points(), out.triangles);
  ASSERT_GT(pairs.size(), 1000U);  // more than are listed
  EXPECT_EQ(report["self_intersections"], pairs.size());
  ASSERT_EQ(report["self_intersecting_pairs"].size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i)
    EXPECT_EQ(report["self_intersecting_pairs"][i], json(pairs[i]));
  // It is written, but nobody may take it for a success; what it encloses means nothing.
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(report["usable"], false);
  EXPECT_GT(report["intersecting_triangles"], 20);
  for (const char* number : {"volume", "centroid", "inertia"})
    EXPECT_TRUE(report["measures"][number].is_null()) << number;
  EXPECT_EQ(result.output.find("centroid"), std::string::npos);
}

TEST_F(ReconstructionTool, SmoothingMovesThePointsAloneAndTellsHowFar) {
  const Positions noisy =
      spherical_param::test::withNoise(ellipsoid(1000), 0.01, 3).cast<float>().cast<double>();
  const Positions gray = Positions::Constant(3, 1000, 99.0);
  write("noisy.ply", plyOf(noisy, {}, gray));
  const json report = reportOf({"noisy.ply", "out.ply", "-smoothing", "3"});
  const MeshFile out = mesh("out.ply");
  EXPECT_EQ(out.colors(), gray);
  EXPECT_TRUE(out.isSphere());
  const json& smoothing = report["smoothing"];
  const double moved = (out.points() - noisy).colwise().norm().maxCoeff();
  EXPECT_GT(moved, 0.001);
  constexpr double rounding = 1e-6;  // of single precision
  EXPECT_NEAR(smoothing["max_displacement"], moved, rounding);
  EXPECT_EQ(smoothing["self_intersections"], selfIntersections(out.points(), out.triangles).size());
  // All else of the report is about the points of the input.
  EXPECT_EQ(report["self_intersections"], selfIntersections(noisy, out.triangles).size());
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
