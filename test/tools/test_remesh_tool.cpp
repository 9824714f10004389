// pcl_spherical_param_remesh, run as a user does.

#include "tool_runner.h"

#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace {

using nlohmann::json;
using tool_test::readFile;
using tool_test::run;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

constexpr double kPi = 3.14159265358979323846;
const Eigen::Vector3d axes(2.0, 1.0, 0.7);
const Eigen::Vector3d center(10.0, 0.0, 0.0);

std::vector<Eigen::Vector3d> spiral(int count) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

/// Linear, so that what is interpolated between the points is as good as the surface there.
Eigen::Vector3d colorAt(const Eigen::Vector3d& direction) {
  return 127.5 * (direction.normalized() + Eigen::Vector3d::Ones());
}

/// Points of an ellipsoid as lines of text, coloured by the direction of the point.
std::string coloredEllipsoid(int count) {
  std::ostringstream text;
  text.precision(9);
  for (const Eigen::Vector3d& direction : spiral(count)) {
    const Eigen::Vector3d point = center + axes.cwiseProduct(direction);
    text << point.transpose() << " " << colorAt(direction).array().round().matrix().transpose()
         << "\n";
  }
  return text.str();
}

/// What an ASCII PLY file of this tool holds.
struct Mesh {
  std::map<std::string, std::vector<double>> properties;  ///< of the vertices, by name
  spherical_param::Triangles triangles;

  std::size_t vertexCount() const { return properties.at("x").size(); }
  Eigen::Vector3d vector(std::size_t i, const std::array<const char*, 3>& names) const {
    return {properties.at(names[0])[i], properties.at(names[1])[i], properties.at(names[2])[i]};
  }
  Eigen::Vector3d point(std::size_t i) const { return vector(i, {"x", "y", "z"}); }
};

Mesh readAsciiPly(const std::string& path) {
  Mesh mesh;
  std::istringstream file(readFile(path));
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line) && line != "end_header";) {
    std::istringstream words(line);
    std::string keyword;
    std::string type;
    std::string name;
    words >> keyword >> type >> name;
    if (keyword == "element") {
      (type == "vertex" ? vertices : triangles) = std::stoul(name);
    } else if (keyword == "property" && type != "list") {
      names.push_back(name);
    }
  }
  for (std::size_t i = 0; i < vertices; ++i) {
    for (const std::string& name : names) {
      double value = 0.0;
      file >> value;
      mesh.properties[name].push_back(value);
    }
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    int corners = 0;
    file >> corners >> mesh.triangles(0, t) >> mesh.triangles(1, t) >> mesh.triangles(2, t);
    EXPECT_EQ(corners, 3);
  }
  EXPECT_FALSE(file.fail());
  return mesh;
}

void expectSphere(const Mesh& mesh) {
  EXPECT_TRUE(spherical_param::checkTopology(mesh.triangles, mesh.vertexCount()).isSphere());
}

/// A TIFF file as TIFF 6.0 describes it, read without the tools.
struct Tiff {
  std::map<unsigned, std::vector<std::uint32_t>> tags;
  std::vector<float> samples;
};

Tiff readTiff(const std::string& content) {
  const auto integer = [&content](std::size_t offset, std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint32_t{static_cast<unsigned char>(content.at(offset + i))} << (8 * i);
    }
    return value;
  };
  Tiff tiff;
  EXPECT_EQ(content.substr(0, 4), std::string("II*\0", 4));
  const std::size_t directory = integer(4, 4);
  for (std::size_t i = 0; i < integer(directory, 2); ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    const std::size_t size = integer(entry + 2, 2) == 3 ? 2 : 4;
    const std::size_t count = integer(entry + 4, 4);
    const std::size_t place = size * count > 4 ? integer(entry + 8, 4) : entry + 8;
    for (std::size_t k = 0; size * count < content.size() && k < count; ++k) {
      tiff.tags[integer(entry, 2)].push_back(integer(place + size * k, size));
    }
  }
  for (std::size_t strip = 0; strip < tiff.tags[273].size(); ++strip) {
    for (std::size_t k = 0; k < tiff.tags[279][strip]; k += 4) {
      const std::uint32_t bits = integer(tiff.tags[273][strip] + k, 4);
      float sample = 0.0F;
      std::memcpy(&sample, &bits, sizeof(sample));
      tiff.samples.push_back(sample);
    }
  }
  return tiff;
}

class RemeshTool : public testing::Test {
protected:
  void SetUp() override { writeFile(directory.file("in.xyz"), coloredEllipsoid(500)); }

  RunResult tool(const std::vector<std::string>& arguments) const {
    RunOptions options;
    options.directory = directory.path();
    return run(REMESH_TOOL, arguments, options);
  }

  json reportOf(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-json", "-"});
    const RunResult result = tool(all);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output, nullptr, false);
  }

  void expectRefused(const std::vector<std::string>& arguments, int exit_code,
                     const std::string& cause) const {
    const auto before = directory.listing();
    const RunResult result = tool(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << cause;
    const std::vector<std::string> lines = result.errorLines();
    ASSERT_EQ(lines.size(), 2U) << result.errors;
    EXPECT_NE(lines[0].find(cause), std::string::npos) << lines[0];
    EXPECT_EQ(lines[1].rfind("  remedy: ", 0), 0U) << lines[1];
    EXPECT_EQ(directory.listing(), before) << cause;
  }

  const TemporaryDirectory directory;
};

TEST_F(RemeshTool, MakesAClosedSphereWithTheNearestNumberOfPointsNormalsAndColors) {
  // 10 f^2 + 2 and 4 f^2 + 2.
  for (const auto& [grid, wanted, made] :
       {std::tuple("icosahedral", "1000", 1002U), std::tuple("octahedral", "1000", 1026U)}) {
    ASSERT_EQ(tool({"in.xyz", "out.ply", "-grid", grid, "-points", wanted, "-ascii"}).exit_code, 0);
    const Mesh mesh = readAsciiPly(directory.file("out.ply"));
    ASSERT_EQ(mesh.vertexCount(), made);
    expectSphere(mesh);
    for (std::size_t i = 0; i < made; ++i) {
      const Eigen::Vector3d direction = (mesh.point(i) - center).cwiseQuotient(axes);
      EXPECT_NEAR(direction.norm(), 1.0, 0.01);
      const Eigen::Vector3d normal = mesh.vector(i, {"nx", "ny", "nz"});
      EXPECT_GT(normal.dot(direction.cwiseQuotient(axes).normalized()), 0.98);
      const Eigen::Vector3d color = mesh.vector(i, {"red", "green", "blue"});
      EXPECT_LT((color - colorAt(direction)).cwiseAbs().maxCoeff(), 6.0);
    }
  }
}

TEST_F(RemeshTool, HasAsManyPointsAsTheMeshUnlessTold) {
  EXPECT_EQ(reportOf({"in.xyz", "out.ply"})["points"], 492);
  EXPECT_EQ(reportOf({"in.xyz", "out.tif"})["points"], 486);
  EXPECT_EQ(reportOf({"in.xyz", "out.xyz", "-grid", "even"})["points"], 500);
}

TEST_F(RemeshTool, WritesTheSphereWithTheSameTriangles) {
  ASSERT_EQ(tool({"in.xyz", "out.ply", "-sphere", "sphere.ply", "-ascii"}).exit_code, 0);
  const Mesh mesh = readAsciiPly(directory.file("out.ply"));
  const Mesh sphere = readAsciiPly(directory.file("sphere.ply"));
  EXPECT_EQ(sphere.triangles, mesh.triangles);
  EXPECT_EQ(sphere.properties.count("nx"), 0U);
  EXPECT_EQ(sphere.properties.at("red"), mesh.properties.at("red"));
  ASSERT_EQ(sphere.vertexCount(), mesh.vertexCount());
  for (std::size_t i = 0; i < sphere.vertexCount(); ++i) {
    EXPECT_NEAR(sphere.point(i).norm(), 1.0, 2e-7);  // the rounding of three floats
  }
}

TEST_F(RemeshTool, GeometryImageHasThreeFloatsAPixelAndOneBorder) {
  const json report = reportOf({"in.xyz", "out.tiff", "-side", "33"});
  EXPECT_EQ(report["grid"]["side"], 33);
  EXPECT_EQ(report["points"], 32 * 32 + 2);
  Tiff tiff = readTiff(readFile(directory.file("out.tiff")));
  using Values = std::vector<std::uint32_t>;
  EXPECT_EQ(tiff.tags[256], Values{33});
  EXPECT_EQ(tiff.tags[257], Values{33});
  EXPECT_EQ(tiff.tags[258], (Values{32, 32, 32}));
  EXPECT_EQ(tiff.tags[259], Values{1});
  EXPECT_EQ(tiff.tags[277], Values{3});
  EXPECT_EQ(tiff.tags[339], (Values{3, 3, 3}));
  ASSERT_EQ(tiff.samples.size(), 3U * 33 * 33);
  const auto pixel = [&tiff](std::size_t row, std::size_t column) {
    const std::size_t first = 3 * (33 * row + column);
    return std::array<float, 3>{tiff.samples[first], tiff.samples[first + 1],
                                tiff.samples[first + 2]};
  };
  for (std::size_t i = 0; i < 33; ++i) {
    EXPECT_EQ(pixel(0, i), pixel(0, 32 - i));
    EXPECT_EQ(pixel(32, i), pixel(32, 32 - i));
    EXPECT_EQ(pixel(i, 0), pixel(32 - i, 0));
    EXPECT_EQ(pixel(i, 32), pixel(32 - i, 32));
  }
}

TEST_F(RemeshTool, MeshOfAGeometryImageIsTheOctahedralGridBitForBit) {
  ASSERT_EQ(tool({"in.xyz", "image.tif", "-points", "1000"}).exit_code, 0);
  const json report = reportOf({"image.tif", "back.ply", "-ascii", "-sphere", "sphere.ply"});
  EXPECT_EQ(report["points"], 1026);
  EXPECT_EQ(report["closed"], true);
  EXPECT_EQ(report["grid"]["side"], 33);
  ASSERT_EQ(
      tool({"in.xyz", "grid.ply", "-grid", "octahedral", "-points", "1000", "-ascii"}).exit_code,
      0);
  const Mesh back = readAsciiPly(directory.file("back.ply"));
  const Mesh grid = readAsciiPly(directory.file("grid.ply"));
  expectSphere(back);
  for (const char* axis : {"x", "y", "z"}) {
    EXPECT_EQ(back.properties.at(axis), grid.properties.at(axis)) << axis;
  }
  EXPECT_EQ(back.triangles, grid.triangles);
  EXPECT_EQ(readAsciiPly(directory.file("sphere.ply")).triangles, grid.triangles);
}

TEST_F(RemeshTool, ReadsImagesOfTheOtherByteOrder) {
  ASSERT_EQ(tool({"in.xyz", "image.tif", "-side", "9"}).exit_code, 0);
  std::string image = readFile(directory.file("image.tif"));
  const Tiff tiff = readTiff(image);
  const auto reverse = [&image](std::size_t offset, std::size_t size, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < size / 2; ++k) {
        std::swap(image.at(offset + size * i + k), image.at(offset + size * (i + 1) - 1 - k));
      }
    }
  };
  const auto word = [&image](std::size_t offset, std::size_t size) {
    std::size_t value = 0;
    for (std::size_t k = size; k-- > 0;) {
      value = 256 * value + static_cast<unsigned char>(image.at(offset + k));
    }
    return value;
  };
  const std::size_t entries = word(8, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = 10 + 12 * i;
    const std::size_t type = word(entry + 2, 2);
    const std::size_t size = type == 2 ? 1 : type == 3 ? 2 : 4;
    const std::size_t count = word(entry + 4, 4) * (type == 5 ? 2 : 1);
    if (size * count > 4) {
      reverse(word(entry + 8, 4), size, count);
      reverse(entry + 8, 4, 1);
    } else {
      reverse(entry + 8, size, count);
    }
    reverse(entry, 2, 2);
    reverse(entry + 4, 4, 1);
  }
  reverse(8, 2, 1);
  reverse(4, 4, 1);
  reverse(2, 2, 1);
  reverse(tiff.tags.at(273).front(), 4, tiff.samples.size());
  image.replace(0, 2, "MM");
  writeFile(directory.file("other.tif"), image);
  ASSERT_EQ(tool({"image.tif", "a.ply"}).exit_code, 0);
  const RunResult result = tool({"other.tif", "b.ply"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(readFile(directory.file("a.ply")), readFile(directory.file("b.ply")));
}

TEST_F(RemeshTool, EvenCloudHasThatManyPointsOnTheSurfaceWithNormals) {
  ASSERT_EQ(tool({"in.xyz", "out.ply", "-grid", "even", "-points", "777", "-ascii"}).exit_code, 0);
  const Mesh cloud = readAsciiPly(directory.file("out.ply"));
  ASSERT_EQ(cloud.vertexCount(), 777U);
  EXPECT_EQ(cloud.triangles.cols(), 0);
  double nearest = 1e9;
  for (std::size_t i = 0; i < 777; ++i) {
    const Eigen::Vector3d direction = (cloud.point(i) - center).cwiseQuotient(axes);
    EXPECT_NEAR(direction.norm(), 1.0, 0.01);
    EXPECT_GT(cloud.vector(i, {"nx", "ny", "nz"}).dot(direction.cwiseQuotient(axes).normalized()),
              0.98);
    const Eigen::Vector3d color = cloud.vector(i, {"red", "green", "blue"});
    EXPECT_LT((color - colorAt(direction)).cwiseAbs().maxCoeff(), 6.0);
    for (std::size_t k = 0; k < i; ++k) {
      nearest = std::min(nearest, (cloud.point(i) - cloud.point(k)).norm());
    }
  }
  // The area is about 17.6: of random points some would be a hundredth of this apart.
  EXPECT_GT(nearest, 0.4 * std::sqrt(17.6 / 777));
  const json report = reportOf({"in.xyz", "out.pcd", "-grid", "even", "-points", "50"});
  EXPECT_EQ(report["points"], 50);
  EXPECT_EQ(report["triangles"], 0);
  EXPECT_TRUE(report["closed"].is_null());
}

TEST_F(RemeshTool, HarmonicsOfASphereAreItsCenterAndItsRadius) {
  std::ostringstream text;
  text.precision(9);
  for (const Eigen::Vector3d& direction : spiral(2000)) {
    text << (3.0 * direction + center).transpose() << "\n";
  }
  writeFile(directory.file("sphere.xyz"), text.str());
  const json report = reportOf({"sphere.xyz", "series.ply", "-series", "-harmonics", "c.json",
                                "-degree", "4", "-points", "642", "-ascii"});
  const json file = json::parse(readFile(directory.file("c.json")));
  EXPECT_EQ(file["degree"], 4);
  EXPECT_TRUE(file["convention"].is_string());
  ASSERT_EQ(file["coefficients"].size(), 25U);
  EXPECT_LT(file["rms_residual"], 0.05);
  EXPECT_EQ(file["rms_residual"], report["harmonics"]["rms_residual"]);
  // The mean of the position over the sphere is c_00 Y_00; the map may be turned, so that of the
  // others the lengths alone are known: each axis has the length 3 sqrt(4 pi / 3).
  const json& constant = file["coefficients"][0];
  EXPECT_EQ(constant["l"], 0);
  EXPECT_EQ(constant["m"], 0);
  const double to_mean = std::sqrt(4.0 * kPi);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(constant["xyz"][axis].get<double>() / to_mean,
                center[static_cast<Eigen::Index>(axis)], 0.02);
    double squares = 0.0;
    for (std::size_t i = 1; i < 4; ++i) {
      EXPECT_EQ(file["coefficients"][i]["l"], 1);
      squares += std::pow(file["coefficients"][i]["xyz"][axis].get<double>(), 2);
    }
    EXPECT_NEAR(std::sqrt(squares), 3.0 * std::sqrt(4.0 * kPi / 3.0), 0.05);
  }
  // The mesh of the series is the series at the points of the sphere.
  const Mesh mesh = readAsciiPly(directory.file("series.ply"));
  ASSERT_EQ(mesh.vertexCount(), 642U);
  expectSphere(mesh);
  for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
    EXPECT_NEAR((mesh.point(i) - center).norm(), 3.0, 0.05);
  }
}

TEST_F(RemeshTool, ReportHasAllKeys) {
  const json report = reportOf({"in.xyz", "out.ply", "-points", "1000", "-threads", "2"});
  for (const char* key : {"input_points", "vertices", "mesh_triangles", "flipped_triangles",
                          "points", "triangles", "components", "genus", "self_intersections",
                          "mesh_self_intersections", "peak_memory_bytes"}) {
    EXPECT_TRUE(report[key].is_number_integer()) << key;
  }
  EXPECT_EQ(report["flipped_triangles"], 0);
  EXPECT_EQ(report["vertices"], 500);
  EXPECT_EQ(report["points"], 1002);
  EXPECT_EQ(report["triangles"], 2000);
  EXPECT_EQ(report["genus"], 0);
  EXPECT_EQ(report["self_intersections"], 0);
  for (const char* key : {"closed", "manifold", "oriented"}) {
    EXPECT_EQ(report[key], true) << key;
  }
  for (const char* key : {"angle_distortion", "area_distortion"}) {
    for (const json& distortion : {report, report["embedding_distortion"]}) {
      EXPECT_GE(distortion[key]["mean"], 1.0) << key;
      EXPECT_GE(distortion[key]["p95"], distortion[key]["mean"]) << key;
      EXPECT_GE(distortion[key]["max"], distortion[key]["p95"]) << key;
    }
  }
  EXPECT_TRUE(report["embedding_distortion"]["flipped_triangles"].is_number_integer());
  EXPECT_EQ(report["grid"]["kind"], "icosahedral");
  EXPECT_EQ(report["grid"]["frequency"], 10);
  EXPECT_TRUE(report["grid"]["side"].is_null());
  EXPECT_TRUE(report["harmonics"].is_null());
  EXPECT_EQ(report["untangling"]["self_intersections_before"], 0);
  EXPECT_EQ(report["untangling"]["moved"], 0);
  // The volume of the ellipsoid, less what a mesh of 500 points lacks.
  EXPECT_NEAR(report["volume"], 4.0 / 3.0 * kPi * axes.prod(), 0.15);
  EXPECT_LE(report["distance"]["mean"], report["distance"]["rms"]);
  EXPECT_LE(report["distance"]["rms"], report["distance"]["max"]);
  EXPECT_LT(report["distance"]["max"], 0.05);
  std::vector<std::string> stages;
  for (const json& stage : report["stages"]) {
    stages.push_back(stage["name"]);
  }
  const std::vector<std::string> expected = {
      "read", "neighbors", "graph",    "embedding", "triangulation", "optimization", "quality",
      "map",  "surface",   "resample", "untangle",  "verify",        "write"};
  EXPECT_EQ(stages, expected);
  EXPECT_EQ(report["options"]["points"], 1000);
  EXPECT_EQ(report["options"]["fit"], "smooth");
  EXPECT_EQ(report["options"]["threads"], 2);
  EXPECT_EQ(report["options"]["seed"], 1);
  EXPECT_TRUE(report["options"]["degree"].is_null());
  EXPECT_TRUE(report["warnings"].is_array());
}

TEST_F(RemeshTool, OptionsOfTheMapReachIt) {
  const json even = reportOf({"in.xyz", "out.ply", "-area-weight", "0.9"});
  const json conformal = reportOf({"in.xyz", "out.ply", "-area-weight", "0"});
  EXPECT_LT(even["area_distortion"]["mean"], conformal["area_distortion"]["mean"]);
  EXPECT_GT(even["angle_distortion"]["mean"], conformal["angle_distortion"]["mean"]);
  const json valid_only = reportOf({"in.xyz", "out.ply", "-map-sweeps", "0"});
  EXPECT_EQ(valid_only["flipped_triangles"], 0);
  EXPECT_NE(valid_only["area_distortion"], even["area_distortion"]);
}

TEST_F(RemeshTool, LinearSurfaceIsNearerToTheMeshThanTheSmoothOneAndFurtherFromTheEllipsoid) {
  const auto deviation = [this](const std::string& fit) {
    EXPECT_EQ(tool({"in.xyz", "out.ply", "-points", "2562", "-fit", fit, "-ascii"}).exit_code, 0);
    const Mesh mesh = readAsciiPly(directory.file("out.ply"));
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.vertexCount(); ++i) {
      sum += std::abs((mesh.point(i) - center).cwiseQuotient(axes).norm() - 1.0);
    }
    return sum / static_cast<double>(mesh.vertexCount());
  };
  EXPECT_LT(deviation("smooth"), 0.5 * deviation("linear"));
}

TEST_F(RemeshTool, SameBytesForAnyNumberOfThreads) {
  std::map<std::string, std::string> first;
  for (const char* threads : {"1", "2", "3"}) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"in.xyz", "out.ply", "-points", "5000", "-sphere", "s.ply",
                                   "-harmonics", "c.json", "-degree", "8"},
          {"in.xyz", "out.tif", "-points", "5000"},
          {"in.xyz", "out.pcd", "-grid", "even"}}) {
      std::vector<std::string> all = arguments;
      all.insert(all.end(), {"-threads", threads});
      ASSERT_EQ(tool(all).exit_code, 0);
    }
    const auto files = directory.listing();
    if (first.empty()) {
      first = files;
    }
    EXPECT_EQ(files, first) << threads;
  }
}

TEST_F(RemeshTool, OptionsThatDoNothingAreRefused) {
  ASSERT_EQ(tool({"in.xyz", "image.tif", "-side", "9"}).exit_code, 0);
  const std::string nothing = " does nothing with ";
  expectRefused({"in.xyz", "out.ply", "-side", "9"}, 2, "-side" + nothing);
  expectRefused({"in.xyz", "out.tif", "-side", "9", "-points", "9"}, 2, "-side" + nothing);
  expectRefused({"in.xyz", "out.tif", "-series"}, 2, "-series" + nothing);
  expectRefused({"in.xyz", "out.ply", "-grid", "even", "-series"}, 2, "-series" + nothing);
  expectRefused({"in.xyz", "out.ply", "-degree", "5"}, 2, "-degree" + nothing);
  expectRefused({"in.xyz", "out.ply", "-map-sweeps", "0", "-area-weight", "1"}, 2,
                "-area-weight" + nothing);
  for (const char* option : {"-points=9", "-fit=linear", "-k=9", "-map-sweeps=2", "-grid=even"}) {
    expectRefused({"image.tif", "out.ply", option}, 2, nothing);
  }
  expectRefused({"image.tif", "out.ply", "-series"}, 2, nothing);
}

TEST_F(RemeshTool, WrongUsageIsRefused) {
  expectRefused({}, 2, "there is no input file");
  expectRefused({"in.xyz"}, 2, "there is no output file");
  expectRefused({"in.xyz", "a.ply", "b.ply"}, 2, "one file too many");
  expectRefused({"in.xyz", "out.ply", "-points", "3"}, 2, "-points");
  expectRefused({"in.xyz", "out.xyz", "-grid", "even", "-points", "16777217"}, 2, "-points");
  expectRefused({"in.xyz", "out.tif", "-side", "10"}, 2, "10 is even");
  expectRefused({"in.xyz", "out.ply", "-grid", "cubic"}, 2, "'cubic' is unknown");
  expectRefused({"in.xyz", "out.ply", "-harmonics", ""}, 2, "-harmonics");
  expectRefused({"in.xyz", "out.png"}, 2, "out.png");
  expectRefused({"in.xyz", "out.stl", "-grid", "even"}, 2, "out.stl");
  expectRefused({"in.stl", "out.ply"}, 2, "in.stl");
  expectRefused({"a.tif", "b.tif"}, 2, "geometry image");
  expectRefused({"in.xyz", "out.ply", "-harmonics", "out.ply"}, 2, "would overwrite");
}

TEST_F(RemeshTool, WhatCannotBeDoneFailsAndLeavesNothing) {
  expectRefused({"missing.xyz", "out.ply"}, 1, "missing.xyz");
  expectRefused({"missing.tif", "out.ply"}, 1, "missing.tif");
  expectRefused({"in.xyz", "no/out.ply"}, 1, "no directory");
  expectRefused({"in.xyz", "out.ply", "-harmonics", "no/c.json"}, 1, "no directory");
  writeFile(directory.file("flat.xyz"), "0 0 0\n1 0 0\n0 1 0\n1 1 0\n.5 .2 0\n");
  expectRefused({"flat.xyz", "out.ply"}, 1, "cannot mesh 'flat.xyz'");
}

TEST_F(RemeshTool, FullDiskIsAnErrorAndKeepsWhatWasThere) {
  writeFile(directory.file("kept.tif"), "kept");
  const auto before = directory.listing();
  RunOptions options;
  options.directory = directory.path();
  options.file_size_limit = 30000;
  // 12 bytes each of 65 * 65 pixels.
  const RunResult result = run(REMESH_TOOL, {"in.xyz", "kept.tif", "-side", "65"}, options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("File too large"), std::string::npos) << result.errors;
  EXPECT_EQ(directory.listing(), before);
}

TEST_F(RemeshTool, CorruptImagesAreRefused) {
  ASSERT_EQ(tool({"in.xyz", "good.tif", "-side", "9"}).exit_code, 0);
  const std::string good = readFile(directory.file("good.tif"));
  const std::string path = directory.file("bad.tif");
  const auto expect_refused = [&](const std::string& content, const std::string& cause) {
    writeFile(path, content);
    expectRefused({"bad.tif", "out.ply"}, 1, cause);
  };
  expect_refused("", "empty");
  expect_refused("no image at all", "no TIFF file");
  expect_refused(good.substr(0, 100), "ends too early");
  expect_refused(good.substr(0, good.size() - 1), "ends too early");
  // Entries of the directory that tell of something else: type and count stay.
  const auto changed = [&good](unsigned tag, std::uint16_t value) {
    std::string content = good;
    for (std::size_t entry = 10;; entry += 12) {
      if (static_cast<unsigned char>(content.at(entry)) +
              256U * static_cast<unsigned char>(content.at(entry + 1)) ==
          tag) {
        content.at(entry + 8) = static_cast<char>(value % 256);
        content.at(entry + 9) = static_cast<char>(value / 256);
        return content;
      }
    }
  };
  expect_refused(changed(256, 8), "8 x 9 pixels");
  expect_refused(changed(258, 60000), "ends too early");
  expect_refused(changed(273, 60000), "ends too early");
  std::string infinite = good;
  const std::uint32_t bits = 0x7f800000;
  std::memcpy(infinite.data() + infinite.size() - 4, &bits, sizeof(bits));
  expect_refused(infinite, "not finite");
}

TEST_F(RemeshTool, CorruptBytesNeverCrash) {
  ASSERT_EQ(tool({"in.xyz", "good.tif", "-side", "5"}).exit_code, 0);
  const std::string good = readFile(directory.file("good.tif"));
  // All of header and directory; the positions behind may be any.
  for (std::size_t i = 0; i < 194; i += 3) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    writeFile(directory.file("bad.tif"), bad);
    const RunResult result = tool({"bad.tif", "out.ply", "-quiet"});
    EXPECT_EQ(result.signal, 0) << i;
    EXPECT_TRUE(result.exit_code == 0 || result.errorLines().size() == 2) << i;
  }
}

TEST_F(RemeshTool, PrintsStagesAndVerdict) {
  const RunResult result = tool({"in.xyz", "out.ply", "-points", "1000"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  for (const char* text :
       {"\n  map ", "\n  resample ", "(the nearest possible to 1000)", "area distortion",
        "flipped on sphere   0", "closed              yes", "self-intersections  0", "distance"}) {
    EXPECT_NE(result.output.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(tool({"in.xyz", "out.ply", "-quiet"}).output, "");
  const RunResult help = tool({"-h"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* text : {"-grid NAME", "-area-weight X", "-graph NAME", ".tif"}) {
    EXPECT_NE(help.output.find(text), std::string::npos) << text;
  }
}

}  // namespace
