// The page of -report: its data are taken apart by code of its own and compared with the mesh.

#include "tool_runner.h"

#include "common/cloud_reconstruction.h"
#include "common/console.h"
#include "common/html_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/packed_array.h"
#include "common/report_mesh.h"
#include "common/report_page.h"
#include "scan_shapes.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/sphere_map.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <set>
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
  std::size_t count = 0;
  std::vector<std::uint32_t> integers;  ///< row after row
  std::vector<double> values;           ///< the same by min and max, or the integers

  double at(std::size_t row, std::size_t c) const { return values[row * components + c]; }
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

std::string inflated(const std::string& packed, std::size_t size) {
  std::string bytes(size + 1, '\0');
  auto length = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                       reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  EXPECT_EQ(length, size);
  bytes.resize(size);
  return bytes;
}

Array decodedArray(const json& info, const std::string& text) {
  Array array;
  array.components = info.at("components");
  array.count = info.at("count");
  const std::string type = info.at("type");
  const std::size_t bytes = type == "u8" ? 1 : type == "u16" ? 2 : 4;
  const std::string planes = inflated(decodedBase64(text), array.components * array.count * bytes);
  array.integers.resize(array.components * array.count);
  const double largest = type == "u8" ? 255.0 : 65535.0;
  for (std::size_t c = 0; c < array.components; ++c) {
    std::uint64_t value = 0;
    for (std::size_t row = 0; row < array.count; ++row) {
      std::uint64_t difference = 0;
      for (std::size_t b = 0; b < bytes; ++b) {
        const auto byte = static_cast<unsigned char>(planes[(c * bytes + b) * array.count + row]);
        difference |= static_cast<std::uint64_t>(byte) << (8 * b);
      }
      value = (value + difference) % (std::uint64_t{1} << (8 * bytes));
      array.integers[row * array.components + c] = static_cast<std::uint32_t>(value);
    }
  }
  for (std::size_t i = 0; i < array.integers.size(); ++i) {
    const double q = array.integers[i];
    if (info.contains("min")) {
      const double min = info["min"][i % array.components];
      const double max = info["max"][i % array.components];
      array.values.push_back(min + q / largest * (max - min));
    } else {
      array.values.push_back(q);
    }
  }
  return array;
}

/// Takes a page apart as a browser does: an element ends at the first "</script>".
Page decoded(const std::string& html) {
  Page page;
  page.size = html.size();
  const auto element = [&](const std::string& type, const std::string& id) {
    const std::string start = "<script type=\"" + type + "\" id=\"" + id + "\">";
    const std::size_t begin = html.find(start);
    EXPECT_NE(begin, std::string::npos) << id;
    const std::size_t end = html.find("</script>", begin);
    return html.substr(begin + start.size(), end - begin - start.size());
  };
  page.data = json::parse(element("application/json", "report-data"));
  for (const auto& [name, info] : page.data.at("arrays").items()) {
    page.texts[name] = element("text/plain", "array-" + name);
    page.arrays[name] = decodedArray(info, page.texts[name]);
  }
  return page;
}

/// A cloud on its way through the parts of the tool.
struct Shown {
  std::unique_ptr<CloudReconstruction> cloud = std::make_unique<CloudReconstruction>();
  Page page;
};

Shown runWith(const TemporaryDirectory& directory, const std::string& input,
              ReconstructionSettings settings, std::size_t most_triangles = kMostReportTriangles,
              const Json& more = Json::object(), std::string_view page = kBarePage) {
  Shown run;
  keepForHtmlReport(settings);
  Console console(false);
  reconstructCloud(directory.file(input), settings, console, *run.cloud);
  OutputFile file(directory.file("page.html"));
  HtmlReportInput report;
  report.tool = "tool";
  report.command = "tool in out";
  report.report = {{"input", "a</script><b>"}};
  report.report.update(more);
  report.cloud = run.cloud.get();
  report.threads = settings.options.threads;
  writeHtmlReport(file, page, report, most_triangles);
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
    mesh.vertices.addPoint({scan(0, i), scan(1, i), scan(2, i)});
  }
  std::vector<Point>& all = mesh.vertices.points;
  if (with_extras) {
    for (std::size_t i = 0; i < points / 20; ++i) {
      all.push_back(all[7 * i]);
    }
    for (std::size_t i = 0; i < 5; ++i) {
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(100 * i),
                 {3.0F, static_cast<float>(i), -2.0F});
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      mesh.vertices.colors.push_back({static_cast<std::uint8_t>(i % 251),
                                      static_cast<std::uint8_t>(i / 251),
                                      static_cast<std::uint8_t>(255 - i % 13), 255});
    }
  }
  OutputFile file(path);
  writeMesh(file, mesh, FileFormat::Ply, Encoding::Binary);
  file.commit();
}

ReconstructionSettings flipsAlone() {
  ReconstructionSettings settings;
  settings.options.optimization = spherical_param::OptimizationMethod::Flips;
  settings.options.attempts = 1;
  settings.options.threads = 2;
  return settings;
}

Triangles trianglesOf(const Array& array) {
  Triangles triangles(3, static_cast<Index>(array.count));
  for (std::size_t i = 0; i < array.integers.size(); ++i) {
    triangles.data()[i] = static_cast<Index>(array.integers[i]);
  }
  return triangles;
}

using Corners = std::array<Index, 3>;

/// The triangle from its least vertex on.
Corners canonical(Corners corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// The vertex of the mesh that each vertex of the page is: the place is that up to half a step.
std::vector<Index> matched(const Page& page, const Positions& vertices) {
  const Array& positions = page["positions"];
  const json& info = page.data["arrays"]["positions"];
  using Key = std::array<std::uint32_t, 3>;
  std::multimap<Key, Index> by_key;
  for (Index v = 0; v < vertices.cols(); ++v) {
    Key key{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double min = info["min"][c];
      const double max = info["max"][c];
      const double share = (vertices(static_cast<Index>(c), v) - min) / (max - min);
      key[c] = static_cast<std::uint32_t>(std::lround(65535.0 * share));
    }
    by_key.emplace(key, v);
  }
  std::vector<Index> result;
  for (std::size_t row = 0; row < positions.count; ++row) {
    const auto found = by_key.find({positions.integers[3 * row], positions.integers[3 * row + 1],
                                    positions.integers[3 * row + 2]});
    EXPECT_NE(found, by_key.end());
    EXPECT_EQ(by_key.count(found->first), 1U) << "the test's scan is too dense";
    result.push_back(found->second);
  }
  return result;
}

/// All that the contract says of the arrays' sizes and ranges.
void expectConsistent(const Page& page) {
  const json& mesh = page.data["mesh"];
  const std::size_t v = mesh["shown_vertices"];
  const std::size_t t = mesh["shown_triangles"];
  EXPECT_EQ(page.data["format"], 1);
  EXPECT_EQ(page["positions"].count, v);
  EXPECT_EQ(page["sphere"].count, v);
  EXPECT_EQ(page["triangles"].count, t);
  EXPECT_EQ(page["suspicious"].count, t);
  for (const std::string name : {"area_distortion", "angle_distortion", "residual"}) {
    EXPECT_EQ(page[name].count, v);
    for (const double value : page[name].values) {
      ASSERT_TRUE(std::isfinite(value));
    }
  }
  EXPECT_GE(*std::min_element(page["angle_distortion"].values.begin(),
                              page["angle_distortion"].values.end()),
            1.0);
  EXPECT_TRUE(spherical_param::checkTopology(trianglesOf(page["triangles"]), v).isSphere());
  for (std::size_t row = 0; row < v; ++row) {
    const double length =
        std::hypot(page["sphere"].at(row, 0), page["sphere"].at(row, 1), page["sphere"].at(row, 2));
    ASSERT_NEAR(length, 1.0, 1e-4);
  }
  const json& history = page.data["history"];
  ASSERT_TRUE(history.is_object());
  const std::size_t h = history["vertices"];
  EXPECT_EQ(page["history_positions"].count, h);
  EXPECT_EQ(page["history_triangles"].count, history["triangles"]);
  EXPECT_EQ(page["history_frames"].count, h * history["frames"].size());
  EXPECT_GE(history["frames"].size(), 3U);
  EXPECT_LE(history["frames"].size(), 40U);
  EXPECT_EQ(history["frames"].back()["step"], "end");
  EXPECT_EQ(history["frames"].back()["level"], 0);
  EXPECT_TRUE(spherical_param::checkTopology(trianglesOf(page["history_triangles"]), h).isSphere());
}

TEST(HtmlReport, HoldsTheMeshUpToRounding) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Animal, 3000);
  const Shown run = runWith(directory, "in.ply", {});
  const Page& page = run.page;
  expectConsistent(page);
  const spherical_param::Result& result = run.cloud->result();
  EXPECT_FALSE(page.data["mesh"]["decimated"]);
  EXPECT_EQ(page.data["mesh"]["vertices"], result.vertexCount());
  EXPECT_EQ(page.data["mesh"]["triangles"], result.triangles.cols());
  EXPECT_EQ(page.arrays.count("cloud"), 0U);
  EXPECT_EQ(page.arrays.count("colors"), 0U);
  const std::vector<Index> vertices = matched(page, vertexPositions(*run.cloud));
  EXPECT_EQ(std::set<Index>(vertices.begin(), vertices.end()).size(), result.vertexCount());

  std::map<Corners, Index> triangles;
  for (Index t = 0; t < result.triangles.cols(); ++t) {
    triangles[canonical({result.triangles(0, t), result.triangles(1, t), result.triangles(2, t)})] =
        t;
  }
  const Array& shown = page["triangles"];
  std::set<Index> seen;
  for (std::size_t row = 0; row < shown.count; ++row) {
    const auto found = triangles.find(
        canonical({vertices[shown.integers[3 * row]], vertices[shown.integers[3 * row + 1]],
                   vertices[shown.integers[3 * row + 2]]}));
    ASSERT_NE(found, triangles.end());
    seen.insert(found->second);
    EXPECT_EQ(page["suspicious"].integers[row],
              result.diagnosis.triangle_marks[static_cast<std::size_t>(found->second)]);
  }
  EXPECT_EQ(seen.size(), triangles.size());

  const json& range = page.data["arrays"]["residual"];
  for (std::size_t row = 0; row < vertices.size(); ++row) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(page["sphere"].at(row, c), result.sphere(static_cast<Index>(c), vertices[row]),
                  1.01 / 65535.0);
    }
    const double residual =
        std::log10(result.vertex_residuals[static_cast<std::size_t>(vertices[row])]);
    const double min = range["min"][0];
    const double max = range["max"][0];
    EXPECT_NEAR(page["residual"].values[row], std::clamp(residual, min, max),
                0.51 / 255.0 * (max - min));
  }
}

TEST(HtmlReport, HistoryEndsAtTheSphereAndBeginsElsewhere) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Hand, 4000);
  for (const auto solver : {spherical_param::EmbeddingMethod::Multilevel,
                            spherical_param::EmbeddingMethod::Iterative}) {
    ReconstructionSettings settings = flipsAlone();
    settings.options.solver = solver;
    const Shown run = runWith(directory, "in.ply", settings);
    const Page& page = run.page;
    expectConsistent(page);
    const Array& positions = page["history_positions"];
    const Array& frames = page["history_frames"];
    const Positions vertices = vertexPositions(*run.cloud);
    const std::size_t last = frames.count - positions.count;
    double moved = 0.0;
    for (std::size_t row = 0; row < positions.count; ++row) {
      const Eigen::Vector3d place(positions.at(row, 0), positions.at(row, 1), positions.at(row, 2));
      Index nearest = 0;
      (vertices.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(frames.at(last + row, c),
                    run.cloud->result().sphere(static_cast<Index>(c), nearest), 1.01 / 65535.0);
        moved = std::max(moved, std::abs(frames.at(last + row, c) - frames.at(row, c)));
      }
    }
    EXPECT_GT(moved, 0.1);
  }
}

TEST(HtmlReport, ShowsSmoothedPointsOutliersAndColours) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Head, 3000, true, 0.5);
  ReconstructionSettings settings;
  settings.options.threads = 2;
  settings.options.smoothing_steps = 5;
  settings.outlier_sigma = 6.0;
  const Shown run = runWith(directory, "in.ply", settings);
  const Page& page = run.page;
  expectConsistent(page);
  const spherical_param::Result& result = run.cloud->result();
  EXPECT_GT(result.duplicates, 100U);
  const std::vector<Index> vertices = matched(page, result.smoothed);
  for (std::size_t row = 0; row < vertices.size(); ++row) {
    const int index =
        run.cloud->reconstruction.getVertexIndices()[static_cast<std::size_t>(vertices[row])];
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(page["colors"].integers[3 * row + c],
                run.cloud->data.colors[static_cast<std::size_t>(index)][c]);
    }
  }
  // The cloud as it was read, far points and repeated ones as well.
  EXPECT_EQ(page["cloud"].count, run.cloud->data.points.size());
  ASSERT_EQ(page["cloud_removed"].count, page["cloud"].count);
  EXPECT_EQ(static_cast<std::size_t>(std::count(page["cloud_removed"].integers.begin(),
                                                page["cloud_removed"].integers.end(), 1U)),
            run.cloud->outliers->indices.size());
  EXPECT_GE(run.cloud->outliers->indices.size(), 5U);
  for (std::size_t row = 0; row < page["cloud"].count; ++row) {
    if (page["cloud"].at(row, 0) > 2.5) {
      EXPECT_EQ(page["cloud_removed"].integers[row], 1U);
    }
  }
}

TEST(HtmlReport, AnOutlierFarOffLeavesTheStepsToTheObject) {
  const TemporaryDirectory directory;
  ScanOptions options;
  options.shape = Shape::Head;
  options.points = 2000;
  const Positions scan = generateScan(options).points;
  TriangleMesh mesh;
  for (Index i = 0; i < scan.cols(); ++i) {
    mesh.vertices.addPoint({scan(0, i), scan(1, i), scan(2, i)});
  }
  mesh.vertices.addPoint({-3000.0F, 1000.0F, 0.0F});
  OutputFile file(directory.file("in.ply"));
  writeMesh(file, mesh, FileFormat::Ply, Encoding::Binary);
  file.commit();
  ReconstructionSettings settings = flipsAlone();
  settings.outlier_sigma = 6.0;
  const Shown run = runWith(directory, "in.ply", settings);
  const Page& page = run.page;
  ASSERT_EQ(page["cloud"].count, 2001U);
  const Eigen::Vector3d low = scan.rowwise().minCoeff();
  const Eigen::Vector3d high = scan.rowwise().maxCoeff();
  const double diagonal = (high - low).norm();
  bool found = false;
  for (std::size_t row = 0; row < page["cloud"].count; ++row) {
    const Eigen::Vector3d place(page["cloud"].at(row, 0), page["cloud"].at(row, 1),
                                page["cloud"].at(row, 2));
    if (page["cloud_removed"].integers[row] != 0 && place.x() < low.x() - diagonal / 4.0) {
      // In its direction, but near.
      EXPECT_NEAR((place - (low + high) / 2.0).norm(), diagonal, 1e-3 * diagonal);
      EXPECT_NEAR((place - (low + high) / 2.0).y() / (place - (low + high) / 2.0).x(), -1.0 / 3.0,
                  1e-2);
      found = true;
      continue;
    }
    EXPECT_LT((scan.colwise() - place).colwise().norm().minCoeff(), 1e-4 * diagonal);
  }
  EXPECT_TRUE(found);
}

TEST(HtmlReport, DistortionHasStepsEnoughForItsColours) {
  const TemporaryDirectory directory;
  // Limbs are squeezed by many powers of two; a sphere is not.
  for (const auto& [shape, type] : {std::pair<Shape, std::string>{Shape::Hand, "u16"},
                                    std::pair<Shape, std::string>{Shape::Sphere, "u8"}}) {
    writeScan(directory.file("in.ply"), shape, 4000);
    const Shown run = runWith(directory, "in.ply", flipsAlone());
    const ReportMesh mesh = reportMesh(*run.cloud, kMostReportTriangles, 2);
    const json& arrays = run.page.data["arrays"];
    EXPECT_EQ(arrays["area_distortion"]["type"], type);
    const double most_angle = arrays["angle_distortion"]["max"][0];
    for (std::size_t v = 0; v < mesh.area_distortion.size(); ++v) {
      const double area = mesh.area_distortion[v];
      const double min = arrays["area_distortion"]["min"][0];
      const double max = arrays["area_distortion"]["max"][0];
      // Less than a hundredth of the colours of its side.
      const double side = area < 0.0 ? std::abs(min) : std::abs(max);
      EXPECT_NEAR(run.page["area_distortion"].values[v], std::clamp(area, min, max), side / 100.0);
      const double angle = std::min(mesh.angle_distortion[v], most_angle);
      EXPECT_NEAR(std::log(run.page["angle_distortion"].values[v]), std::log(angle),
                  std::max(0.01, std::log(most_angle) / 100.0));
    }
    // One vertex of a hundred has the last colour.
    const auto beyond = std::count_if(mesh.angle_distortion.begin(), mesh.angle_distortion.end(),
                                      [&](double angle) { return angle > most_angle; });
    EXPECT_NEAR(static_cast<double>(beyond), 40.0, 2.0);
  }
}

TEST(HtmlReport, ArraysAreTheSameForAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Animal, 6000, true);
  std::map<std::string, std::string> first;
  for (const int threads : {1, 2, 3}) {
    ReconstructionSettings settings = flipsAlone();
    settings.options.threads = threads;
    settings.options.smoothing_steps = 2;
    settings.outlier_sigma = 8.0;
    const Shown run = runWith(directory, "in.ply", settings, 3000);
    if (threads == 1) {
      first = run.page.texts;
    }
    EXPECT_EQ(run.page.texts, first) << threads;
  }
}

TEST(HtmlReport, IsAboutAsLargeAsTheMeshInBinary) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Head, 50000);
  // With the program of the page, where this build has it.
  const Shown run = runWith(directory, "in.ply", flipsAlone(), kMostReportTriangles, Json::object(),
                            reportPage().empty() ? kBarePage : reportPage());
  expectConsistent(run.page);
  OutputFile file(directory.file("mesh.ply"));
  writeMesh(file, meshOf(*run.cloud), FileFormat::Ply, Encoding::Binary);
  file.commit();
  const auto mesh_size =
      static_cast<double>(std::filesystem::file_size(directory.file("mesh.ply")));
  EXPECT_LT(static_cast<double>(run.page.size), 1.2 * mesh_size);
}

TEST(HtmlReport, MoreThan300000TrianglesAreDecimatedToAClosedMesh) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Head, 200000);
  const Shown run = runWith(directory, "in.ply", flipsAlone());
  const Page& page = run.page;
  expectConsistent(page);
  EXPECT_TRUE(page.data["mesh"]["decimated"]);
  EXPECT_EQ(page.data["mesh"]["vertices"], 200000);
  EXPECT_EQ(page.data["mesh"]["triangles"], 399996);
  EXPECT_LE(page.data["mesh"]["shown_triangles"], 300000);
  EXPECT_GE(page.data["mesh"]["shown_triangles"], 200000);
  EXPECT_LE(page.data["history"]["vertices"], 5000);
}

TEST(HtmlReport, DecimatedMeshHasTheShapeAndTheSuspiciousPlaces) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Bowl, 8000);
  const Shown whole = runWith(directory, "in.ply", flipsAlone());
  const Shown run = runWith(directory, "in.ply", flipsAlone(), 4000);
  const Page& page = run.page;
  expectConsistent(page);
  EXPECT_TRUE(page.data["mesh"]["decimated"]);
  const spherical_param::Result& result = run.cloud->result();
  const auto lids = [](const Page& of) {
    return std::count_if(of["suspicious"].integers.begin(), of["suspicious"].integers.end(),
                         [](std::uint32_t mark) { return (mark & 2U) != 0; });
  };
  EXPECT_GT(lids(whole.page), 10);
  EXPECT_GT(lids(page), lids(whole.page) / 2);
  const std::vector<Index> vertices = matched(page, vertexPositions(*run.cloud));
  // What is shown of a vertex is its own, and the area is about that of the whole mesh.
  for (std::size_t row = 0; row < vertices.size(); ++row) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(page["sphere"].at(row, c), result.sphere(static_cast<Index>(c), vertices[row]),
                  1.01 / 65535.0);
    }
  }
  double area = 0.0;
  for (std::size_t row = 0; row < page["triangles"].count; ++row) {
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = page["triangles"].integers[3 * row + k];
      corners[k] = {page["positions"].at(v, 0), page["positions"].at(v, 1),
                    page["positions"].at(v, 2)};
    }
    area += (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2.0;
  }
  EXPECT_NEAR(area, result.area, 0.1 * result.area);
}

TEST(HtmlReport, ALongListOfResidualsIsThinnedFromTheFirstToTheLast) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Sphere, 100);
  const auto shown = [&](std::size_t count) {
    Json residuals = Json::array();
    for (std::size_t i = 0; i < count; ++i) {
      residuals.push_back(i);
    }
    const Shown run = runWith(directory, "in.ply", flipsAlone(), kMostReportTriangles,
                              {{"residuals", residuals}});
    EXPECT_EQ(run.page.data["residual_count"], count);
    return run.page.data["report"]["residuals"];
  };
  const json few = shown(1600);
  ASSERT_EQ(few.size(), 1600U);
  EXPECT_EQ(few[77], 77);
  const json many = shown(200000);
  ASSERT_EQ(many.size(), 2000U);
  EXPECT_EQ(many[0], 0);
  EXPECT_EQ(many[1000], 100049);
  EXPECT_EQ(many[1999], 199999);
}

TEST(HtmlReport, TinyCloudsHaveAPage) {
  const TemporaryDirectory directory;
  for (const std::size_t points : {4U, 5U, 12U}) {
    writeScan(directory.file("in.ply"), Shape::Sphere, points);
    const Shown run = runWith(directory, "in.ply", {});
    EXPECT_EQ(run.page["triangles"].count, 2 * points - 4);
    EXPECT_TRUE(run.page.data["history"].is_object());
  }
}

TEST(PackedArray, ComesBackWhateverTheNumbers) {
  std::mt19937 random(3);
  for (const PackedType type : {PackedType::U8, PackedType::U16, PackedType::U32}) {
    for (const std::size_t rows : {0U, 1U, 2U, 1000U}) {
      PackedArray array;
      array.type = type;
      array.components = 3;
      const int bits = 8 * static_cast<int>(type);
      for (std::size_t i = 0; i < 3 * rows; ++i) {
        array.values.push_back(static_cast<std::uint32_t>(random()) >> (32 - bits));
      }
      const json info = {
          {"type", "u" + std::to_string(bits)}, {"components", 3}, {"count", array.rows()}};
      EXPECT_EQ(decodedArray(info, textOf(array)).integers, array.values);
    }
  }
}

TEST(PackedArray, QuantisesWithinHalfAStepAndClamps) {
  const PackedArray array = quantized("a", PackedType::U8, {-5.0, 0.0, 0.1, 1.0, 7.0}, 0.0, 1.0);
  EXPECT_EQ(array.values, (std::vector<std::uint32_t>{0, 0, 26, 255, 255}));
  const PackedArray flat = quantized("b", PackedType::U16, 2, {3.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(flat.values, (std::vector<std::uint32_t>{0, 0, 0, 65535}));
  EXPECT_EQ(flat.min, (std::vector<double>{3.0, 1.0}));
}

TEST(PackedArray, Base64IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(EvenSubset, IsOfTheSizeThatIsAskedForAndKeepsWhatItMust) {
  ScanOptions options;
  options.points = 5000;
  const Positions points = generateScan(options).points;
  std::vector<bool> kept(5000, false);
  for (std::size_t i = 0; i < 5000; i += 50) {
    kept[i] = true;
  }
  for (const std::size_t count : {4U, 50U, 500U, 2000U, 4999U, 5000U}) {
    const std::vector<Index> subset = evenSubset(points, kept, count);
    EXPECT_LE(subset.size(), count);
    EXPECT_GE(10 * subset.size(), 8 * count);
    EXPECT_TRUE(std::is_sorted(subset.begin(), subset.end()));
    EXPECT_EQ(std::adjacent_find(subset.begin(), subset.end()), subset.end());
    if (count >= 500) {
      for (Index i = 0; i < 5000; i += 50) {
        EXPECT_TRUE(std::binary_search(subset.begin(), subset.end(), i));
      }
    }
  }
}

TEST(TraversalOrder, AVertexMayHaveHalfOfTheTrianglesAndOthersNone) {
  // Two cones over one rim, their triangles in any order, and as many vertices of no triangle.
  constexpr Index rim = 100000;
  Triangles triangles(3, 2 * rim);
  std::vector<Index> order(2 * rim);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  for (Index i = 0; i < rim; ++i) {
    const Index a = 2 + i;
    const Index b = 2 + (i + 1) % rim;
    triangles.col(order[static_cast<std::size_t>(2 * i)]) << 0, a, b;
    triangles.col(order[static_cast<std::size_t>(2 * i + 1)]) << b, a, 1;
  }
  constexpr std::size_t count = 3 * rim;
  const spherical_param::tools::MeshOrder result = traversalOrder(triangles, count);
  ASSERT_EQ(result.vertices.size(), count);
  ASSERT_EQ(result.triangles.size(), std::size_t{2} * rim);
  EXPECT_EQ(std::set<Index>(result.vertices.begin(), result.vertices.end()).size(), count);
  EXPECT_EQ(result.vertices[0], 0);
  // Around the first vertex one after the other.
  for (Index t = 0; t < rim; ++t) {
    EXPECT_EQ(result.renumbered(0, t), 0);
    EXPECT_EQ(result.renumbered(1, t), 1 + t);
    EXPECT_EQ(result.renumbered(2, t), 1 + (t + 1) % rim);
  }
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    const auto column = static_cast<Index>(t);
    Corners corners{};
    for (Index k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] =
          result.vertices[static_cast<std::size_t>(result.renumbered(k, column))];
    }
    const auto old = triangles.col(result.triangles[t]);
    ASSERT_EQ(canonical(corners), canonical({old[0], old[1], old[2]}));
  }
}

TEST(ReportMesh, ResidualsThatAreNoNumbersAreTheLeast) {
  EXPECT_DOUBLE_EQ(residualExponent(1e-5), -5.0);
  EXPECT_DOUBLE_EQ(residualExponent(0.0), -17.0);
  EXPECT_DOUBLE_EQ(residualExponent(1e-30), -17.0);
  EXPECT_DOUBLE_EQ(residualExponent(std::numeric_limits<double>::quiet_NaN()), -17.0);
  EXPECT_DOUBLE_EQ(residualExponent(std::numeric_limits<double>::infinity()), -17.0);
}

TEST(ReportMesh, ItsDistortionOfAnglesIsThatOfTheCore) {
  const TemporaryDirectory directory;
  writeScan(directory.file("in.ply"), Shape::Animal, 2000);
  const Shown run = runWith(directory, "in.ply", flipsAlone());
  const ReportMesh mesh = reportMesh(*run.cloud, kMostReportTriangles, 1);
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
      runTool(directory, {input, escaped, "-report", "page.HTML", "-json", "report.json", "-smooth",
                          "2", "-quiet", "-lambda=0.25"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string html = tool_test::readFile(directory.file("page.HTML"));
  const Page page = decoded(html);
  expectConsistent(page);
  // Nothing but the data is between the two parts of the page.
  const std::string_view whole = reportPage();
  const std::size_t place = whole.find("<!--DATA-->");
  ASSERT_NE(place, std::string::npos);
  EXPECT_EQ(html.substr(0, place), whole.substr(0, place));
  const std::string_view rest = whole.substr(place + std::string_view("<!--DATA-->").size());
  ASSERT_GT(html.size(), rest.size());
  EXPECT_EQ(html.substr(html.size() - rest.size()), rest);

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
                                      "-lambda", "0.25", "-seed", "1", "-smooth", "2", "-report",
                                      "page.HTML", "-json", "report.json", "-quiet"}));
}

TEST_F(ReportTool, ItsCommandRepeatsTheRun) {
  const TemporaryDirectory directory;
  writeScan(directory.file("-it's in.ply"), Shape::Animal, 900);
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"-seed", "3", "-outliers", "9"},
        std::vector<std::string>{"-solver", "iterative", "-optimize", "none", "-iterations",
                                 "20"}}) {
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
