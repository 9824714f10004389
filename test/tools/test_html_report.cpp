// The page of -report: its data are taken apart by code of its own and compared with the mesh.

#include "tool_runner.h"

#include "common/cloud_reconstruction.h"
#include "common/console.h"
#include "common/html_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/report_mesh.h"
#include "common/report_page.h"
#include "scan_shapes.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/mesh_topology.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using nlohmann::json;
using spherical_param::Index;
using spherical_param::Positions;
using spherical_param::Triangles;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;

constexpr std::string_view kBarePage = "<html>\n<!--DATA-->\n</html>\n";

/// An array as the page reads it.
struct Array {
  std::size_t components = 0;
  std::vector<std::uint32_t> integers;  ///< row after row
  std::vector<double> values;           ///< the same by min and max, or the integers

  std::size_t rows() const { return integers.size() / components; }
  Eigen::Vector3d point(std::size_t row) const {
    return Eigen::Map<const Eigen::Vector3d>(values.data() + 3 * row);
  }
};

struct Page {
  json data;
  std::map<std::string, Array> arrays;
  std::map<std::string, std::string> texts;  ///< of the arrays
  std::size_t size = 0;

  const Array& operator[](const std::string& name) const { return arrays.at(name); }
};

std::string decodedBase64(const std::string& text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const auto digit = std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                   "0123456789+/")
                           .find(c);
    if (digit == std::string::npos) {
      EXPECT_EQ(c, '=');
      continue;
    }
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes += static_cast<char>((bits >> static_cast<unsigned>(count)) & 0xffU);
    }
  }
  return bytes;
}

std::string inflated(const std::string& packed) {
  std::string bytes(std::max<std::size_t>(1 << 22, 40 * packed.size()), '\0');
  auto length = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                       reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  bytes.resize(length);
  return bytes;
}

Array decodedArray(const json& about, const std::string& bytes) {
  Array array;
  array.components = about.at("components");
  const unsigned bits = about.at("bits");
  const std::uint32_t largest = 0xffffffffU >> (32 - bits);
  for (std::size_t i = 0; 8 * i < 8 * bytes.size() / (bits / 8); ++i) {
    std::uint32_t value = i < array.components ? 0 : array.integers[i - array.components];
    for (std::size_t b = 0; b < bits / 8; ++b) {
      value += std::uint32_t{static_cast<unsigned char>(bytes[i * (bits / 8) + b])} << (8 * b);
    }
    array.integers.push_back(value & largest);
    const std::size_t c = i % array.components;
    const double min = about.contains("min") ? about["min"][c].get<double>() : 0.0;
    const double max = about.contains("max") ? about["max"][c].get<double>() : largest;
    array.values.push_back(min +
                           array.integers.back() / static_cast<double>(largest) * (max - min));
  }
  return array;
}

/// Takes a page apart as a browser does: an element ends at the first "</script>".
Page decoded(const std::string& html) {
  Page page;
  page.size = html.size();
  const auto element = [&](const std::string& id) {
    const std::string start = "<script type=\"text/plain\" id=\"" + id + "\">";
    const std::size_t begin = html.find(start);
    EXPECT_NE(begin, std::string::npos) << id;
    const std::size_t end = html.find("</script>", begin);
    return html.substr(begin + start.size(), end - begin - start.size());
  };
  page.data = json::parse(inflated(decodedBase64(element("data"))));
  for (const auto& [name, about] : page.data.at("arrays").items()) {
    page.texts[name] = element("array-" + name);
    page.arrays[name] = decodedArray(about, inflated(decodedBase64(page.texts[name])));
  }
  return page;
}

/// A cloud on its way through the parts of the tool.
struct Shown {
  std::unique_ptr<CloudReconstruction> cloud = std::make_unique<CloudReconstruction>();
  ReportMesh mesh;
  Page page;
};

Shown runWith(const TemporaryDirectory& directory, ReconstructionSettings settings,
              std::size_t max_triangles = kMaxReportTriangles) {
  Shown run;
  keepForHtmlReport(settings);
  Console console(false);
  reconstructCloud(directory.file("in.ply"), settings, console, *run.cloud);
  const int threads = settings.options.threads;
  run.mesh = reportMesh(*run.cloud, max_triangles, threads);
  OutputFile file(directory.file("page.html"));
  writeHtmlReport(file, kBarePage,
                  {"tool", "tool in out", {{"input", "in.ply"}}, run.cloud.get(), threads},
                  max_triangles);
  file.commit();
  run.page = decoded(tool_test::readFile(directory.file("page.html")));
  return run;
}

/// Writes a generated scan, or one with colours, some points twice and some far outside.
void writeScan(const std::string& path, Shape shape, std::size_t points, bool with_extras = false,
               double noise = 0.0) {
  ScanOptions options;
  options.shape = shape;
  options.points = points;
  options.noise = noise;
  const Positions scan = generateScan(options).points;
  TriangleMesh mesh;
  for (Index i = 0; i < scan.cols(); ++i) {
    mesh.vertices.points.push_back({scan(0, i), scan(1, i), scan(2, i)});
  }
  std::vector<Point>& all = mesh.vertices.points;
  if (with_extras) {
    for (std::size_t i = 0; i < points / 20; ++i) {
      all.push_back(all[7 * i]);
    }
    for (std::size_t i = 0; i < 5; ++i) {
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(100 * i),
                 {3.0, static_cast<double>(i), -2.0});
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      mesh.vertices.colors.push_back({static_cast<std::uint8_t>(i % 251),
                                      static_cast<std::uint8_t>(i / 251),
                                      static_cast<std::uint8_t>(255 - i % 13), 255});
    }
  }
  OutputFile file(path);
  writeMesh(file, mesh, formatOf("a.ply"), Encoding::Binary);
  file.commit();
}

ReconstructionSettings flipsAlone() {
  ReconstructionSettings settings;
  settings.options.optimization.method = spherical_param::OptimizationMethod::Flips;
  settings.options.retries = 0;
  settings.options.threads = 2;
  return settings;
}

Triangles trianglesOf(const Array& array) {
  Triangles triangles(3, static_cast<Index>(array.rows()));
  std::copy(array.integers.begin(), array.integers.end(), triangles.data());
  return triangles;
}

double shareOf(double value, double min, double max) {
  return max > min ? (std::clamp(value, min, max) - min) / (max - min) : 0.0;
}

/// The page holds what is to be shown, in steps of its arrays.
void expectShown(const Shown& run) {
  const Page& page = run.page;
  const ReportMesh& mesh = run.mesh;
  const auto v = static_cast<std::size_t>(mesh.positions.cols());
  EXPECT_EQ(page.data["mesh"]["vertices"], run.cloud->result.vertexCount());
  EXPECT_EQ(page.data["mesh"]["triangles"], run.cloud->result.triangles.cols());
  EXPECT_EQ(page.data["mesh"]["shown_vertices"], v);
  EXPECT_EQ(page.data["mesh"]["shown_triangles"], mesh.triangles.cols());
  ASSERT_EQ(page["positions"].rows(), v);
  ASSERT_EQ(page["sphere"].rows(), v);
  EXPECT_EQ(trianglesOf(page["triangles"]), mesh.triangles);
  EXPECT_TRUE(spherical_param::checkTopology(mesh.triangles, v).isSphere());
  EXPECT_EQ(page["suspicious"].integers,
            std::vector<std::uint32_t>(mesh.marks.begin(), mesh.marks.end()));
  const Eigen::Vector3d size =
      mesh.positions.rowwise().maxCoeff() - mesh.positions.rowwise().minCoeff();
  const Positions vertices = vertexPositions(*run.cloud);
  for (std::size_t row = 0; row < v; ++row) {
    const auto column = static_cast<Index>(row);
    const Index vertex = mesh.vertices[row];
    EXPECT_EQ(mesh.positions.col(column), vertices.col(vertex));
    EXPECT_EQ(mesh.sphere.col(column), run.cloud->result.sphere.col(vertex));
    const Eigen::Vector3d off = page["positions"].point(row) - mesh.positions.col(column);
    EXPECT_TRUE((off.cwiseAbs().array() <= 0.51 / 65535.0 * size.array()).all());
    EXPECT_LE((page["sphere"].point(row) - mesh.sphere.col(column)).cwiseAbs().maxCoeff(),
              1.01 / 65535.0);
    // Half a step of 255.
    constexpr double step = 0.51;
    const auto range = [&](const std::string& name, const std::string& end) {
      return page.data["arrays"][name][end][0].get<double>();
    };
    const double area = mesh.area_distortion[row];
    const double side = area < 0.0 ? -range("area", "min") : range("area", "max");
    EXPECT_NEAR(page["area"].integers[row], 255.0 * shareOf(area / side, -1.0, 1.0), step);
    EXPECT_NEAR(page["angle"].integers[row],
                255.0 * shareOf(std::log10(mesh.angle_distortion[row]), range("angle", "min"),
                                range("angle", "max")),
                step);
    EXPECT_NEAR(page["residual"].integers[row],
                255.0 *
                    shareOf(mesh.residual[row], range("residual", "min"), range("residual", "max")),
                step);
  }
  const std::size_t h = page["history_positions"].rows();
  EXPECT_EQ(page["history_frames"].rows(), h * page.data["frames"].size());
  EXPECT_GE(page.data["frames"].size(), 3U);
  EXPECT_EQ(page.data["frames"].back()["step"], "end");
  EXPECT_TRUE(spherical_param::checkTopology(trianglesOf(page["history_triangles"]), h).isSphere());
}

using Corners = std::array<Index, 3>;

/// The triangles of a mesh, each from its least vertex on, and their marks.
std::map<Corners, std::uint8_t> markedTriangles(const Triangles& triangles,
                                                const std::vector<std::uint8_t>& marks,
                                                const std::vector<Index>& vertices) {
  std::map<Corners, std::uint8_t> result;
  for (Index t = 0; t < triangles.cols(); ++t) {
    Corners corners{};
    for (Index k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = vertices[static_cast<std::size_t>(triangles(k, t))];
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result[corners] = marks[static_cast<std::size_t>(t)];
  }
  return result;
}

TEST(HtmlReport, HoldsTheMeshUpToRounding) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Bowl, 3000);
  const Shown run = runWith(directory, flipsAlone());
  expectShown(run);
  const spherical_param::Result& result = run.cloud->result;
  std::vector<Index> all(result.vertexCount());
  std::iota(all.begin(), all.end(), 0);
  const auto marked = markedTriangles(result.triangles, result.diagnosis.triangle_marks, all);
  EXPECT_EQ(markedTriangles(run.mesh.triangles, run.mesh.marks, run.mesh.vertices), marked);
  EXPECT_TRUE(std::any_of(marked.begin(), marked.end(),
                          [](const auto& entry) { return entry.second != 0; }));
  for (std::size_t row = 0; row < all.size(); ++row) {
    const double residual =
        result.vertex_residuals[static_cast<std::size_t>(run.mesh.vertices[row])];
    EXPECT_DOUBLE_EQ(run.mesh.residual[row], std::log10(std::max(residual, 1e-17)));
  }
  EXPECT_EQ(run.page.arrays.count("cloud") + run.page.arrays.count("colors") +
                run.page.arrays.count("outliers"),
            0U);
}

TEST(HtmlReport, HistoryEndsAtTheSphereAndBeginsElsewhere) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Hand, 4000);
  for (const auto method : {spherical_param::EmbeddingMethod::Multilevel,
                            spherical_param::EmbeddingMethod::Iterative}) {
    ReconstructionSettings settings = flipsAlone();
    settings.options.embedding.method = method;
    const Shown run = runWith(directory, settings);
    expectShown(run);
    const Array& positions = run.page["history_positions"];
    const Array& frames = run.page["history_frames"];
    const Positions vertices = vertexPositions(*run.cloud);
    const std::size_t last = frames.rows() - positions.rows();
    double moved = 0.0;
    for (std::size_t row = 0; row < positions.rows(); ++row) {
      Index nearest = 0;
      (vertices.colwise() - positions.point(row)).colwise().squaredNorm().minCoeff(&nearest);
      const Eigen::Vector3d end = frames.point(last + row);
      EXPECT_LE((end - run.cloud->result.sphere.col(nearest)).cwiseAbs().maxCoeff(),
                1.01 / 65535.0);
      moved = std::max(moved, (end - frames.point(row)).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(moved, 0.1);
  }
}

TEST(HtmlReport, ShowsSmoothedPointsOutliersAndColours) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Head, 3000, true, 0.5);
  ReconstructionSettings settings = flipsAlone();
  settings.options.smoothing.steps = 5;
  settings.outlier_sigma = 6.0;
  const Shown run = runWith(directory, settings);
  expectShown(run);
  const Page& page = run.page;
  const std::vector<Point>& points = run.cloud->data.points;
  ASSERT_EQ(page["cloud"].rows(), run.mesh.vertices.size());
  for (std::size_t row = 0; row < run.mesh.vertices.size(); ++row) {
    const auto index = static_cast<std::size_t>(
        run.cloud->point_of_vertex[static_cast<std::size_t>(run.mesh.vertices[row])]);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(page["colors"].integers[3 * row + c], run.cloud->data.colors[index][c]);
      // The object has an extent of about 1.
      EXPECT_NEAR(page["cloud"].values[3 * row + c], points[index][c], 1e-4);
    }
  }
  // Those 3 units off come to the side of a box that is as much larger than the mesh as its
  // diagonal is long, in its middle.
  EXPECT_EQ(page.data["outliers"], run.cloud->outliers->points.size());
  ASSERT_EQ(page["outliers"].rows(), run.cloud->outliers->points.size());
  ASSERT_GE(page["outliers"].rows(), 5U);
  const Eigen::Vector3d high = run.mesh.positions.rowwise().maxCoeff();
  const double margin = (high - run.mesh.positions.rowwise().minCoeff()).norm() / 2.0;
  std::size_t beyond = 0;
  for (std::size_t row = 0; row < page["outliers"].rows(); ++row) {
    const auto index = static_cast<std::size_t>(run.cloud->outliers->points[row]);
    const double x = std::min<double>(points[index][0], high.x() + margin);
    EXPECT_NEAR(page["outliers"].point(row).x(), x, 1e-4);
    beyond += x < points[index][0] ? 1 : 0;
  }
  EXPECT_GE(beyond, 5U);
}

TEST(HtmlReport, ArraysAreTheSameForAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Animal, 6000, true);
  std::map<std::string, std::string> first;
  for (const int threads : {1, 2, 3}) {
    ReconstructionSettings settings = flipsAlone();
    settings.options.threads = threads;
    settings.options.smoothing.steps = 2;
    settings.outlier_sigma = 8.0;
    const Shown run = runWith(directory, settings, 3000);
    if (threads == 1) {
      first = run.page.texts;
    }
    EXPECT_EQ(run.page.texts, first) << threads;
  }
}

TEST(HtmlReport, HasAboutTwelveBytesForATriangle) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Head, 50000);
  const Shown run = runWith(directory, flipsAlone());
  expectShown(run);
  // The program of the page and the unfolding of large meshes are as large for every mesh.
  double size = 0.0;
  for (const auto& [name, text] : run.page.texts) {
    size += name.rfind("history", 0) == 0 ? 0.0 : static_cast<double>(text.size());
  }
  EXPECT_LT(size, 12.5 * static_cast<double>(run.mesh.triangles.cols()));
}

TEST(HtmlReport, AReducedMeshIsClosedAndHasTheShapeAndTheSuspiciousPlaces) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Bowl, 8000);
  const Shown whole = runWith(directory, flipsAlone());
  const Shown run = runWith(directory, flipsAlone(), 4000);
  expectShown(run);
  EXPECT_EQ(run.mesh.triangles.cols(), 4000);
  EXPECT_EQ(std::set<Index>(run.mesh.vertices.begin(), run.mesh.vertices.end()).size(), 2002U);
  const auto holes = [](const Shown& of) {
    return std::count_if(of.mesh.marks.begin(), of.mesh.marks.end(),
                         [](std::uint8_t mark) { return (mark & 2U) != 0; });
  };
  EXPECT_GT(holes(whole), 10);
  EXPECT_GT(holes(run), holes(whole) / 2);
  const auto area = [](const Shown& of) {
    double sum = 0.0;
    for (Index t = 0; t < of.mesh.triangles.cols(); ++t) {
      const Eigen::Vector3d corner = of.mesh.positions.col(of.mesh.triangles(0, t));
      sum += (of.mesh.positions.col(of.mesh.triangles(1, t)) - corner)
                 .cross(of.mesh.positions.col(of.mesh.triangles(2, t)) - corner)
                 .norm();
    }
    return sum;
  };
  // A fourth of the vertices flattens what is round a little.
  EXPECT_NEAR(area(run), area(whole), 0.1 * area(whole));
}

TEST(HtmlReport, TinyCloudsHaveAPage) {
  const TemporaryDirectory directory;
  for (const std::size_t points : {4U, 5U, 12U}) {
    writeScan(directory.file("in.ply"), Shape::Sphere, points);
    expectShown(runWith(directory, {}));
  }
}

TEST(ReportMesh, ItsDistortionOfAnglesIsThatOfTheCore) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Animal, 2000);
  const Shown run = runWith(directory, flipsAlone());
  const ReportMesh& mesh = run.mesh;
  std::vector<double> areas(mesh.angle_distortion.size(), 0.0);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d corner = mesh.positions.col(mesh.triangles(0, t));
    const double area = (mesh.positions.col(mesh.triangles(1, t)) - corner)
                            .cross(mesh.positions.col(mesh.triangles(2, t)) - corner)
                            .norm();
    for (Index k = 0; k < 3; ++k) {
      areas[static_cast<std::size_t>(mesh.triangles(k, t))] += area;
    }
  }
  // Each vertex has the mean over its triangles, by their areas.
  const double mean =
      std::inner_product(areas.begin(), areas.end(), mesh.angle_distortion.begin(), 0.0) /
      std::accumulate(areas.begin(), areas.end(), 0.0);
  const spherical_param::MapDistortion core =
      spherical_param::measureMapDistortion(mesh.positions, mesh.triangles, mesh.sphere, 1);
  EXPECT_NEAR(mean, core.angle.mean, 1e-9 * mean);
}

// The tool itself.

RunResult runTool(const TemporaryDirectory& directory, const std::vector<std::string>& arguments) {
  RunOptions options;
  options.directory = directory.path();
  return tool_test::run(RECONSTRUCTION_TOOL, arguments, options);
}

/// The words of a command line as a shell takes them apart.
std::vector<std::string> shellWords(const TemporaryDirectory& directory,
                                    const std::string& command) {
  RunOptions options;
  options.directory = directory.path();
  const RunResult result = tool_test::run("/bin/sh", {"-c", "printf '%s\\n' " + command}, options);
  std::vector<std::string> words;
  std::istringstream stream(result.output);
  for (std::string line; std::getline(stream, line);) {
    words.push_back(line);
  }
  return words;
}

TEST(ReportOption, RefusesWhatIsNoPageAndLeavesNothingBehind) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Sphere, 200);
  const auto before = directory.listing();
  for (const std::string name : {"", "-", "page", "page.htm", "page.json", ".html", "in.ply"}) {
    const RunResult result = runTool(directory, {"in.ply", "out.ply", "-report=" + name});
    EXPECT_EQ(result.exit_code, 2) << name;
    ASSERT_EQ(result.errorLines().size(), 2U) << result.errors;
    EXPECT_NE(result.errorLines()[1].find("remedy: "), std::string::npos);
    EXPECT_EQ(directory.listing(), before);
  }
  if (reportPage().empty()) {
    const RunResult result = runTool(directory, {"in.ply", "out.ply", "-report", "page.html"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.errors.find("built without the page"), std::string::npos);
    EXPECT_EQ(directory.listing(), before);
  }
}

class ReportTool : public testing::Test {
protected:
  void SetUp() override {
    if (reportPage().empty()) {
      GTEST_SKIP() << "this build has no page of the report";
    }
  }
};

TEST_F(ReportTool, WritesThePageWithTheReportOfJson) {
  const TemporaryDirectory directory;
  const std::string input = "a </script><!-- \"it's\" &.ply";
  const std::string escaped = "b </script>.ply";
  std::filesystem::create_directories(directory.file("a <"));
  std::filesystem::create_directories(directory.file("b <"));
  writeScan(directory.file(input), Shape::Ellipsoid, 500);
  const RunResult result =
      runTool(directory, {input, escaped, "-report", "page.HTML", "-json", "report.json",
                          "-smoothing", "2", "-quiet", "-damping=0.25"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string html = tool_test::readFile(directory.file("page.HTML"));
  const Page page = decoded(html);
  // Nothing but the data is between the two parts of the page, and these are elements of base64.
  const std::string_view whole = reportPage();
  const std::size_t place = whole.find("<!--DATA-->");
  ASSERT_NE(place, std::string::npos);
  EXPECT_EQ(html.substr(0, place), whole.substr(0, place));
  const std::string_view rest = whole.substr(place + std::string_view("<!--DATA-->").size());
  ASSERT_GT(html.size(), rest.size());
  EXPECT_EQ(html.substr(html.size() - rest.size()), rest);
  std::istringstream elements(html.substr(place, html.size() - rest.size() - place));
  for (std::string line; std::getline(elements, line);) {
    EXPECT_TRUE(std::regex_match(line.substr(0, line.find('>')),
                                 std::regex("<script type=\"text/plain\" id=\"[a-z_-]+\"")));
    const std::size_t end = line.size() - std::string_view("</script>").size();
    EXPECT_EQ(line.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                     "0123456789+/=",
                                     line.find('>') + 1),
              end);
    EXPECT_EQ(line.substr(end), "</script>");
  }
  // The page may load nothing, and holds the licence of what it contains of others.
  EXPECT_NE(whole.find("content=\"default-src 'none'; script-src 'sha256-"), std::string::npos);
  EXPECT_EQ(std::regex_search(std::string(whole), std::regex("(src|href)=\"(?!data:)")), false);
  EXPECT_NE(whole.find("three.js authors"), std::string::npos);
  EXPECT_NE(whole.find("Permission is hereby granted, free of charge"), std::string::npos);

  json expected = json::parse(tool_test::readFile(directory.file("report.json")));
  json report = page.data["report"];
  EXPECT_EQ(report["input"], input);
  EXPECT_EQ(report["output"], escaped);
  EXPECT_EQ(report["options"]["report"], "page.HTML");
  EXPECT_EQ(expected["stages"].back()["name"], "report");
  for (json* each : {&expected, &report}) {
    each->erase("peak_memory_bytes");
    each->erase("stages");
  }
  EXPECT_EQ(report, expected);
  EXPECT_EQ(page.data["tool"]["name"], "pcl_spherical_param_reconstruction");
  EXPECT_EQ(shellWords(directory, page.data["command"]),
            (std::vector<std::string>{"pcl_spherical_param_reconstruction", input, escaped,
                                      "-damping", "0.25", "-smoothing", "2", "-seed", "1",
                                      "-report", "page.HTML", "-json", "report.json", "-quiet"}));
}

TEST_F(ReportTool, ItsCommandRepeatsTheRun) {
  const TemporaryDirectory directory;
  writeScan(directory.file("-it's in.ply"), Shape::Animal, 900);
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"-seed", "3", "-outliers", "9"},
        std::vector<std::string>{"-embedding", "iterative", "-optimization", "none",
                                 "-max_iterations", "20"}}) {
    std::vector<std::string> words = {"-report", "page.html", "-quiet"};
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"--", "-it's in.ply", "out.ply"});
    ASSERT_EQ(runTool(directory, words).exit_code, 0);
    const Page first = decoded(tool_test::readFile(directory.file("page.html")));
    const std::string mesh = tool_test::readFile(directory.file("out.ply"));
    std::vector<std::string> again = shellWords(directory, first.data["command"]);
    again.erase(again.begin());
    std::filesystem::remove(directory.file("out.ply"));
    std::filesystem::remove(directory.file("page.html"));
    const RunResult result = runTool(directory, again);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(tool_test::readFile(directory.file("out.ply")), mesh);
    const Page second = decoded(tool_test::readFile(directory.file("page.html")));
    EXPECT_EQ(second.texts, first.texts);
    EXPECT_EQ(second.data["command"], first.data["command"]);
  }
}

TEST_F(ReportTool, MeshIsTheSameWithAndWithoutIt) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Hand, 1500);
  ASSERT_EQ(runTool(directory, {"in.ply", "a.ply", "-sphere", "sa.ply"}).exit_code, 0);
  const RunResult result =
      runTool(directory, {"in.ply", "b.ply", "-sphere", "sb.ply", "-report", "page.html"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_NE(result.output.find("report"), std::string::npos);
  for (const std::string prefix : {"", "s"}) {
    EXPECT_EQ(tool_test::readFile(directory.file(prefix + "a.ply")),
              tool_test::readFile(directory.file(prefix + "b.ply")));
  }
}

TEST_F(ReportTool, AFullDiskLeavesNoFileBehind) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Sphere, 300);
  const auto before = directory.listing();
  RunOptions options;
  options.directory = directory.path();
  // The mesh has room, the page has not.
  options.file_size_limit = 100000;
  const RunResult result =
      tool_test::run(RECONSTRUCTION_TOOL, {"in.ply", "out.ply", "-report", "page.html"}, options);
  EXPECT_EQ(result.exit_code, 1);
  ASSERT_EQ(result.errorLines().size(), 2U) << result.errors;
  EXPECT_NE(result.errors.find("page.html"), std::string::npos);
  EXPECT_EQ(directory.listing(), before);
}

TEST_F(ReportTool, APlaceThatCannotBeWrittenIsToldBeforeTheWork) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Sphere, 300);
  const auto before = directory.listing();
  const RunResult absent =
      runTool(directory, {"in.ply", "out.ply", "-report", "nowhere/page.html"});
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_EQ(absent.errorLines().size(), 2U);
  const RunResult same =
      runTool(directory, {"in.ply", "out.ply", "-report", "r.html", "-json", "r.html"});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_EQ(directory.listing(), before);
}

}  // namespace
