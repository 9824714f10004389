// pcl_spherical_param_reconstruction, run as a user does: files, report and what is printed.

#include "tool_runner.h"

#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pcl/PolygonMesh.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace {

using nlohmann::json;
using tool_test::run;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;

using Point = std::array<float, 3>;
using Color = std::array<int, 3>;

/// A mesh, or a cloud without triangles.
struct Mesh {
  std::vector<Point> points;
  std::vector<Point> normals;
  std::vector<Color> colors;
  std::vector<std::array<int, 3>> triangles;
};

RunResult runTool(const TemporaryDirectory& directory, const std::vector<std::string>& arguments) {
  RunOptions options;
  options.directory = directory.path();
  return run(RECONSTRUCTION_TOOL, arguments, options);
}

/// Points of an ellipsoid on a spiral, with coordinates that need all digits of a float.
Mesh ellipsoid(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const std::array<double, 3> unit = {radius * std::cos(angle), radius * std::sin(angle), z};
    mesh.points.push_back({static_cast<float>(unit[0] / 3.0), static_cast<float>(unit[1] / 7.0),
                           static_cast<float>(10.0 + unit[2] / 9.0)});
    mesh.normals.push_back(
        {static_cast<float>(unit[0]), static_cast<float>(unit[1]), static_cast<float>(unit[2])});
    mesh.colors.push_back({i % 256, (7 * i) % 256, 255 - i % 256});
  }
  return mesh;
}

std::string digits(const Point& values) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), "%.9g %.9g %.9g", static_cast<double>(values[0]),
                static_cast<double>(values[1]), static_cast<double>(values[2]));
  return text.data();
}

std::string digits(const Color& color) {
  return std::to_string(color[0]) + " " + std::to_string(color[1]) + " " + std::to_string(color[2]);
}

pcl::PointCloud<pcl::PointXYZRGBNormal> toPcl(const Mesh& mesh) {
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    pcl::PointXYZRGBNormal point;
    point.getVector3fMap() = Eigen::Map<const Eigen::Vector3f>(mesh.points[i].data());
    point.getNormalVector3fMap() = Eigen::Map<const Eigen::Vector3f>(mesh.normals[i].data());
    point.r = static_cast<std::uint8_t>(mesh.colors[i][0]);
    point.g = static_cast<std::uint8_t>(mesh.colors[i][1]);
    point.b = static_cast<std::uint8_t>(mesh.colors[i][2]);
    cloud.push_back(point);
  }
  return cloud;
}

/// Writes a cloud in the format that the name asks for.
void writeCloud(const std::string& path, const std::string& name, const Mesh& mesh) {
  std::ostringstream text;
  const std::size_t count = mesh.points.size();
  if (name == "in.pcd") {
    pcl::io::savePCDFileBinary(path, toPcl(mesh));
  } else if (name == "ascii.pcd") {
    pcl::PCDWriter().writeASCII(path, toPcl(mesh), 9);
  } else if (name == "compressed.pcd") {
    pcl::io::savePCDFileBinaryCompressed(path, toPcl(mesh));
  } else if (name == "in.ply") {
    pcl::io::savePLYFileBinary(path, toPcl(mesh));
  } else if (name == "ascii.ply") {
    // Double coordinates, and an element before the vertices.
    text << "ply\nformat ascii 1.0\ncomment test\nelement other 1\nproperty int a\n"
         << "element vertex " << count
         << "\nproperty double x\nproperty double y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n5\n";
    for (std::size_t i = 0; i < count; ++i) {
      text << digits(mesh.points[i]) << " " << digits(mesh.normals[i]) << " "
           << digits(mesh.colors[i]) << "\n";
    }
    text << "3 0 1 2\n";
  } else if (name == "in.obj") {
    text << "# test\no object\n";
    for (std::size_t i = 0; i < count; ++i) {
      const Color& color = mesh.colors[i];
      text << "v " << digits(mesh.points[i]) << " " << color[0] / 255.0 << " " << color[1] / 255.0
           << " " << color[2] / 255.0 << "\n";
    }
    // Normals backwards: the faces tell which is whose.
    for (std::size_t i = count; i-- > 0;) {
      text << "vn " << digits(mesh.normals[i]) << "\n";
    }
    for (std::size_t i = 0; i < count; ++i) {
      text << "f " << i + 1 << "//" << count - i << " 1//" << count << " -1//-" << count << "\n";
    }
  } else if (name == "in.vtk") {
    text << "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET POLYDATA\nPOINTS " << count
         << " float\n";
    for (const Point& point : mesh.points) {
      text << digits(point) << "\n";
    }
    text << "POINT_DATA " << count << "\nCOLOR_SCALARS rgb 3\n";
    for (const Color& color : mesh.colors) {
      text << color[0] / 255.0 << " " << color[1] / 255.0 << " " << color[2] / 255.0 << "\n";
    }
    text << "NORMALS normals float\n";
    for (const Point& normal : mesh.normals) {
      text << digits(normal) << "\n";
    }
  } else if (name == "in.xyz") {
    for (std::size_t i = 0; i < count; ++i) {
      text << digits(mesh.points[i]) << " " << digits(mesh.colors[i]) << " "
           << digits(mesh.normals[i]) << "\n";
    }
  } else if (name == "in.txt") {
    text << "# a comment\nx;y;z;nx;ny;nz;r;g;b\n";
    for (std::size_t i = 0; i < count; ++i) {
      std::string line = digits(mesh.points[i]) + " " + digits(mesh.normals[i]) + " " +
                         digits(mesh.colors[i]) + " more";
      for (char& character : line) {
        character = character == ' ' ? ';' : character;
      }
      text << line << " # end\r\n\n";
    }
  } else {
    FAIL() << name;
  }
  if (!text.str().empty()) {
    tool_test::writeFile(path, text.str());
  }
}

Mesh readPly(const std::string& path) {
  pcl::PolygonMesh file;
  EXPECT_EQ(pcl::PLYReader().read(path, file), 0);
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);  // there is no curvature in the file
  pcl::fromPCLPointCloud2(file.cloud, cloud);
  Mesh mesh;
  for (const auto& point : cloud) {
    mesh.points.push_back({point.x, point.y, point.z});
    mesh.normals.push_back({point.normal_x, point.normal_y, point.normal_z});
    mesh.colors.push_back({point.r, point.g, point.b});
  }
  for (const pcl::Vertices& polygon : file.polygons) {
    EXPECT_EQ(polygon.vertices.size(), 3U);
    mesh.triangles.push_back({static_cast<int>(polygon.vertices[0]),
                              static_cast<int>(polygon.vertices[1]),
                              static_cast<int>(polygon.vertices[2])});
  }
  return mesh;
}

Point toPoint(const double* values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

Mesh fromVtk(vtkPolyData& data) {
  Mesh mesh;
  auto* const normals = data.GetPointData()->GetNormals();
  auto* const colors = vtkUnsignedCharArray::SafeDownCast(data.GetPointData()->GetScalars());
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) {
    mesh.points.push_back(toPoint(data.GetPoint(i)));
    if (normals != nullptr) {
      mesh.normals.push_back(toPoint(normals->GetTuple3(i)));
    }
    if (colors != nullptr) {
      mesh.colors.push_back({colors->GetTypedComponent(i, 0), colors->GetTypedComponent(i, 1),
                             colors->GetTypedComponent(i, 2)});
    }
  }
  vtkNew<vtkIdList> cell;
  for (vtkIdType i = 0; i < data.GetPolys()->GetNumberOfCells(); ++i) {
    data.GetPolys()->GetCellAtId(i, cell);
    EXPECT_EQ(cell->GetNumberOfIds(), 3);
    mesh.triangles.push_back({static_cast<int>(cell->GetId(0)), static_cast<int>(cell->GetId(1)),
                              static_cast<int>(cell->GetId(2))});
  }
  return mesh;
}

Mesh readVtk(const std::string& path) {
  vtkNew<vtkPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return fromVtk(*reader->GetOutput());
}

/// STL has no vertices, only corners: they are found again by their coordinates.
Mesh readStl(const std::string& path, const std::vector<Point>& points) {
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  Mesh mesh = fromVtk(*reader->GetOutput());
  std::map<Point, int> index_of_point;
  for (std::size_t i = 0; i < points.size(); ++i) {
    index_of_point[points[i]] = static_cast<int>(i);
  }
  for (auto& triangle : mesh.triangles) {
    for (int& corner : triangle) {
      const auto found = index_of_point.find(mesh.points[static_cast<std::size_t>(corner)]);
      EXPECT_NE(found, index_of_point.end());
      corner = found == index_of_point.end() ? 0 : found->second;
    }
  }
  mesh.points = points;
  return mesh;
}

Mesh readObj(const std::string& path) {
  Mesh mesh;
  std::istringstream file(tool_test::readFile(path));
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    Point point{};
    if (keyword == "f") {
      std::array<int, 3> triangle{};
      for (int& corner : triangle) {
        std::string word;
        words >> word;
        corner = std::stoi(word) - 1;
        EXPECT_EQ(word, std::to_string(corner + 1) + "//" + std::to_string(corner + 1));
      }
      mesh.triangles.push_back(triangle);
      continue;
    }
    words >> point[0] >> point[1] >> point[2];
    (keyword == "v" ? mesh.points : mesh.normals).push_back(point);
    if (keyword == "v") {
      std::array<double, 3> color{};
      words >> color[0] >> color[1] >> color[2];
      mesh.colors.push_back({static_cast<int>(std::lround(255.0 * color[0])),
                             static_cast<int>(std::lround(255.0 * color[1])),
                             static_cast<int>(std::lround(255.0 * color[2]))});
    }
  }
  return mesh;
}

Mesh readOff(const std::string& path) {
  Mesh mesh;
  std::istringstream file(tool_test::readFile(path));
  std::string keyword;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t edges = 0;
  file >> keyword >> vertices >> faces >> edges;
  EXPECT_EQ(keyword, "CNOFF");
  for (std::size_t i = 0; i < vertices; ++i) {
    Point point{};
    Point normal{};
    Color color{};
    int alpha = 0;
    file >> point[0] >> point[1] >> point[2] >> normal[0] >> normal[1] >> normal[2];
    file >> color[0] >> color[1] >> color[2] >> alpha;
    EXPECT_EQ(alpha, 255);
    mesh.points.push_back(point);
    mesh.normals.push_back(normal);
    mesh.colors.push_back(color);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    int corners = 0;
    std::array<int, 3> triangle{};
    file >> corners >> triangle[0] >> triangle[1] >> triangle[2];
    EXPECT_EQ(corners, 3);
    mesh.triangles.push_back(triangle);
  }
  EXPECT_FALSE(file.fail());
  return mesh;
}

Mesh readMesh(const std::string& path, const std::vector<Point>& points) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".ply") {
    return readPly(path);
  }
  if (extension == ".vtk") {
    return readVtk(path);
  }
  if (extension == ".stl") {
    return readStl(path, points);
  }
  return extension == ".obj" ? readObj(path) : readOff(path);
}

/// Every edge once in each direction, every vertex used, V - E + F = 2.
void expectSphere(const Mesh& mesh) {
  std::set<std::pair<int, int>> edges;
  std::set<int> used;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(edges.insert({triangle[c], triangle[(c + 1) % 3]}).second);
      used.insert(triangle[c]);
    }
  }
  for (const auto& [from, to] : edges) {
    EXPECT_EQ(edges.count({to, from}), 1U);
  }
  EXPECT_EQ(used.size(), mesh.points.size());
  ASSERT_FALSE(used.empty());
  EXPECT_GE(*used.begin(), 0);
  EXPECT_LT(*used.rbegin(), static_cast<int>(mesh.points.size()));
  EXPECT_EQ(mesh.points.size() + mesh.triangles.size(), edges.size() / 2 + 2);
}

class Formats : public testing::TestWithParam<std::tuple<std::string, std::string, std::string>> {};

TEST_P(Formats, KeepCoordinatesColorsAndNormals) {
  const auto& [input, output, encoding] = GetParam();
  const TemporaryDirectory directory;
  const Mesh cloud = ellipsoid(300);
  writeCloud(directory.file(input), input, cloud);
  std::vector<std::string> arguments = {input, output};
  if (encoding == "ascii") {
    arguments.push_back("-ascii");
  }
  const RunResult result = runTool(directory, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");

  const Mesh mesh = readMesh(directory.file(output), cloud.points);
  EXPECT_EQ(mesh.points, cloud.points);
  if (output != "out.stl") {
    EXPECT_EQ(mesh.normals, cloud.normals);
    EXPECT_EQ(mesh.colors, cloud.colors);
  }
  expectSphere(mesh);
  const std::string content = tool_test::readFile(directory.file(output));
  const bool has_both = output != "out.obj" && output != "out.off";
  const bool text = content.find('\0') == std::string::npos;
  EXPECT_EQ(text, !has_both || encoding == "ascii");
}

INSTANTIATE_TEST_SUITE_P(
    All, Formats,
    testing::Combine(testing::Values("in.pcd", "ascii.pcd", "compressed.pcd", "in.ply", "ascii.ply",
                                     "in.obj", "in.vtk", "in.xyz", "in.txt"),
                     testing::Values("out.ply", "out.obj", "out.stl", "out.vtk", "out.off"),
                     testing::Values("binary", "ascii")),
    [](const auto& test) {
      std::string name =
          std::get<0>(test.param) + "_" + std::get<1>(test.param) + "_" + std::get<2>(test.param);
      for (char& character : name) {
        character = character == '.' ? '_' : character;
      }
      return name;
    });

class ReconstructionTool : public testing::Test {
protected:
  void SetUp() override { writeCloud(directory.file("in.ply"), "in.ply", cloud); }

  json reportOf(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-json", "-"});
    const RunResult result = runTool(directory, all);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output, nullptr, false);
  }

  const Mesh cloud = ellipsoid(200);
  const TemporaryDirectory directory;
};

TEST_F(ReconstructionTool, KeepsAlpha) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float "
                     "y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty "
                     "uchar blue\nproperty uchar alpha\nend_header\n";
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    text +=
        digits(cloud.points[i]) + " " + digits(cloud.colors[i]) + " " + std::to_string(i) + "\n";
  }
  tool_test::writeFile(directory.file("alpha.ply"), text);
  ASSERT_EQ(runTool(directory, {"alpha.ply", "out.ply", "-ascii"}).exit_code, 0);
  // Header and vertex lines agree with the input, whatever faces follow.
  const std::string written = tool_test::readFile(directory.file("out.ply"));
  EXPECT_NE(written.find("property uchar alpha\n"), std::string::npos);
  const std::string body = text.substr(text.find("end_header\n"));
  EXPECT_NE(written.find(body), std::string::npos);
  ASSERT_EQ(runTool(directory, {"alpha.ply", "out.vtk", "-ascii"}).exit_code, 0);
  EXPECT_NE(tool_test::readFile(directory.file("out.vtk")).find("COLOR_SCALARS Colors 4\n"),
            std::string::npos);
}

TEST_F(ReconstructionTool, ReadsAllPointsWhateverTheCameraOfAPlyFileSays) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 200\nproperty float x\nproperty float "
                     "y\nproperty float z\nelement camera 1\nproperty int viewportx\nproperty int "
                     "viewporty\nend_header\n";
  for (const Point& point : cloud.points) {
    text += digits(point) + "\n";
  }
  for (const char* view : {"20 1", "20 10", "200 1", "1000000 1000000"}) {
    tool_test::writeFile(directory.file("camera.ply"), text + view + "\n");
    EXPECT_EQ(reportOf({"camera.ply", "out.ply"})["vertices"], 200) << view;
  }
}

TEST_F(ReconstructionTool, LeavesOutDuplicatesAndPointsThatAreNotFinite) {
  std::string text = "nan 0 0\n";
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    text += digits(cloud.points[i]) + "\n" + (i % 10 == 0 ? digits(cloud.points[0]) + "\n" : "");
  }
  text += "1 inf 0\n";
  tool_test::writeFile(directory.file("in.xyz"), text);
  const json report = reportOf({"in.xyz", "out.off"});
  EXPECT_EQ(report["points"], 222);
  EXPECT_EQ(report["ignored_points"], 2);
  EXPECT_EQ(report["duplicates"], 20);
  EXPECT_EQ(report["vertices"], 200);
  EXPECT_FALSE(report["warnings"].empty());

  std::istringstream file(tool_test::readFile(directory.file("out.off")));
  std::string keyword;
  std::getline(file, keyword);
  EXPECT_EQ(keyword, "OFF");
  std::getline(file, keyword);
  EXPECT_EQ(keyword, "200 396 0");
  for (const Point& point : cloud.points) {
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, digits(point));
  }
}

TEST_F(ReconstructionTool, WritesTheSphereWithTheSameTriangles) {
  ASSERT_EQ(runTool(directory, {"in.ply", "out.ply", "-sphere", "sphere.vtk"}).exit_code, 0);
  const Mesh mesh = readPly(directory.file("out.ply"));
  const Mesh sphere = readVtk(directory.file("sphere.vtk"));
  EXPECT_EQ(sphere.triangles, mesh.triangles);
  EXPECT_EQ(sphere.colors, mesh.colors);
  EXPECT_TRUE(sphere.normals.empty());
  ASSERT_EQ(sphere.points.size(), mesh.points.size());
  for (const Point& point : sphere.points) {
    // The rounding of three floats.
    EXPECT_NEAR(std::hypot(point[0], point[1], point[2]), 1.0, 2e-7);
  }
}

TEST_F(ReconstructionTool, ReportHasAllKeysWithTheirTypes) {
  ASSERT_EQ(runTool(directory, {"in.ply", "out.ply", "-json", "report.json", "-k=9"}).exit_code, 0);
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  for (const char* key : {"points", "vertices", "duplicates", "ignored_points", "triangles",
                          "components", "genus", "iterations", "peak_memory_bytes"}) {
    EXPECT_TRUE(report[key].is_number_integer()) << key;
  }
  for (const char* key : {"volume", "area", "residual", "edges_outside_graph"}) {
    EXPECT_TRUE(report[key].is_number_float()) << key;
  }
  for (const char* key : {"closed", "manifold", "oriented", "converged"}) {
    EXPECT_TRUE(report[key].is_boolean()) << key;
  }
  for (const char* key : {"stop_reason", "input", "output", "version"}) {
    EXPECT_TRUE(report[key].is_string()) << key;
  }
  for (const char* key : {"residuals", "stages", "warnings"}) {
    EXPECT_TRUE(report[key].is_array()) << key;
  }
  EXPECT_EQ(report["points"], 200);
  EXPECT_EQ(report["vertices"], 200);
  EXPECT_EQ(report["triangles"], 396);
  EXPECT_EQ(report["closed"], true);
  EXPECT_EQ(report["manifold"], true);
  EXPECT_EQ(report["oriented"], true);
  EXPECT_EQ(report["components"], 1);
  EXPECT_EQ(report["genus"], 0);
  EXPECT_GT(report["volume"], 0.0);
  EXPECT_GT(report["peak_memory_bytes"], 1 << 20);
  // Smoothing is no step to a solution.
  EXPECT_EQ(report["stop_reason"], "unfinished");
  EXPECT_EQ(report["converged"], false);
  EXPECT_EQ(report["iterations"], report["embedding"]["levels"][0]["newton_iterations"]);

  std::vector<std::string> stages;
  for (const json& stage : report["stages"]) {
    stages.push_back(stage["name"]);
    EXPECT_TRUE(stage["seconds"].is_number_float());
  }
  const std::vector<std::string> expected = {"read",          "neighbors",    "graph", "embedding",
                                             "triangulation", "optimization", "check", "write"};
  EXPECT_EQ(stages, expected);
  for (const char* key :
       {"graph",    "k",          "solver",     "weights",  "exponent",       "tolerance",
        "lambda",   "iterations", "stagnation", "starts",   "seed",           "hull",
        "optimize", "attempts",   "smooth",     "outliers", "outlier_method", "threads",
        "sphere",   "json",       "ascii",      "quiet"}) {
    EXPECT_TRUE(report["options"].contains(key)) << key;
  }
  EXPECT_EQ(report["options"]["k"], 9);
  EXPECT_EQ(report["options"]["weights"], "adaptive");
  EXPECT_EQ(report["graph"]["method"], "delaunay");
  for (const char* key : {"edges", "components", "without_tangent_plane_count", "searched_again",
                          "uncertified", "weak"}) {
    EXPECT_TRUE(report["graph"][key].is_number_integer()) << key;
  }
  EXPECT_EQ(report["graph"]["components"], 1);
  EXPECT_TRUE(report["graph"]["bridges"].empty());
  EXPECT_TRUE(report["graph"]["without_tangent_plane"].is_array());
  EXPECT_EQ(report["embedding"]["solver"], "multilevel");
  for (const char* key : {"starts", "collapsed_starts"}) {
    EXPECT_TRUE(report["embedding"][key].is_number_integer()) << key;
  }
  for (const char* key : {"centroid_norm", "energy", "operator_complexity", "grid_complexity"}) {
    EXPECT_TRUE(report["embedding"][key].is_number_float()) << key;
  }
  for (const char* key : {"barrier", "added_barrier"}) {
    EXPECT_TRUE(report["embedding"][key].is_boolean()) << key;
  }
  EXPECT_EQ(report["triangulation"]["method"], "incremental");
  for (const char* key : {"hull_vertices", "reinserted", "coincident"}) {
    EXPECT_TRUE(report["triangulation"][key].is_number_integer()) << key;
  }
  EXPECT_TRUE(report["triangulation"]["hull_rejected"].is_boolean());

  EXPECT_TRUE(report["self_intersections"].is_number_integer());
  EXPECT_TRUE(report["self_intersecting_pairs"].is_array());
  EXPECT_TRUE(report["outliers"].is_null());
  EXPECT_TRUE(report["smoothing"].is_null());
  EXPECT_EQ(report["optimization"]["method"], "full");
  for (const char* key : {"energy", "rough", "alignment", "unevenness"}) {
    EXPECT_TRUE(report["optimization"][key].is_number_float()) << key;
  }
  EXPECT_EQ(report["optimization"]["noisy"], false);
  EXPECT_EQ(report["optimization"]["noise_steps"], 0);
  EXPECT_FALSE(report["optimization"]["phases"].empty());
  for (const json& phase : report["optimization"]["phases"]) {
    EXPECT_TRUE(phase["name"].is_string());
    for (const char* key : {"tried", "moves"}) {
      EXPECT_TRUE(phase[key].is_number_integer()) << key;
    }
    for (const char* key : {"energy_before", "energy", "seconds"}) {
      EXPECT_TRUE(phase[key].is_number_float()) << key;
    }
    const json& self_intersections = phase["self_intersections"];
    EXPECT_TRUE(self_intersections.is_null() || self_intersections.is_number_integer());
  }
  EXPECT_FALSE(report["attempts"].empty());
  for (const json& attempt : report["attempts"]) {
    EXPECT_TRUE(attempt["description"].is_string());
    EXPECT_TRUE(attempt["self_intersections"].is_number_integer());
    EXPECT_TRUE(attempt["energy"].is_number_float());
    EXPECT_TRUE(attempt["seconds"].is_number_float());
    EXPECT_TRUE(attempt["chosen"].is_boolean());
  }
  for (const char* key : {"kind", "summary"}) {
    EXPECT_TRUE(report["diagnosis"][key].is_string()) << key;
  }
  EXPECT_TRUE(report["diagnosis"]["looks_closed_genus0"].is_boolean());
  for (const char* key : {"lids", "handles", "bridges"}) {
    EXPECT_TRUE(report["diagnosis"][key].is_array()) << key;
  }
  for (const char* key : {"volume", "area", "mean_edge_length"}) {
    EXPECT_TRUE(report["measures"][key].is_number_float()) << key;
  }
  EXPECT_EQ(report["measures"]["bounding_box"]["min"].size(), 3U);
  EXPECT_EQ(report["measures"]["bounding_box"]["max"].size(), 3U);
  EXPECT_EQ(report["measures"]["centroid"].size(), 3U);
  ASSERT_EQ(report["measures"]["inertia"].size(), 3U);
  EXPECT_EQ(report["measures"]["inertia"][0].size(), 3U);
}

TEST_F(ReconstructionTool, ReportOfTheIterationHasAResidualBeforeEachStepAndAtItsEnd) {
  const json report = reportOf({"in.ply", "out.ply", "-solver", "iterative"});
  EXPECT_GT(report["iterations"], 1);
  EXPECT_EQ(report["residuals"].size(), report["iterations"].get<std::size_t>() + 1);
  EXPECT_EQ(report["residuals"].back(), report["residual"]);
  EXPECT_EQ(report["embedding"]["solver"], "iterative");
  EXPECT_FALSE(report["embedding"].contains("levels"));
}

TEST_F(ReconstructionTool, ReportTellsTheOptionsInForce) {
  const json standard = reportOf({"in.ply", "out.ply"})["options"];
  EXPECT_EQ(standard["graph"], "delaunay");
  EXPECT_EQ(standard["k"], 12);
  EXPECT_EQ(standard["solver"], "multilevel");
  EXPECT_EQ(standard["exponent"], 3.0);
  EXPECT_EQ(standard["starts"], 2);
  EXPECT_EQ(standard["seed"], 1);
  EXPECT_EQ(standard["hull"], "incremental");
  EXPECT_EQ(standard["optimize"], "full");
  EXPECT_EQ(standard["attempts"], 4);
  EXPECT_EQ(standard["smooth"], 0);
  for (const char* key : {"outliers", "outlier_method"}) {
    EXPECT_TRUE(standard[key].is_null()) << key;
  }
  for (const char* key : {"tolerance", "iterations", "stagnation"}) {
    EXPECT_TRUE(standard[key].is_null()) << key;
  }
  const json paper = reportOf({"in.ply", "out.ply", "-graph", "knn", "-solver", "iterative",
                               "-hull", "qhull", "-optimize", "none", "-attempts", "1"})["options"];
  EXPECT_EQ(paper["graph"], "knn");
  EXPECT_EQ(paper["k"], 25);
  EXPECT_EQ(paper["solver"], "iterative");
  EXPECT_EQ(paper["tolerance"], 1e-8);
  EXPECT_EQ(paper["iterations"], 1600);
  EXPECT_EQ(paper["stagnation"], 100);
  EXPECT_EQ(paper["hull"], "qhull");
  EXPECT_EQ(paper["optimize"], "none");
  EXPECT_EQ(paper["attempts"], 1);
  for (const char* key : {"exponent", "starts", "seed"}) {
    EXPECT_TRUE(paper[key].is_null()) << key;
  }
  EXPECT_TRUE(
      reportOf({"in.ply", "out.ply", "-weights", "uniform"})["options"]["exponent"].is_null());
  // The optimisation is random even where the solver is not.
  const json iterative =
      reportOf({"in.ply", "out.ply", "-solver", "iterative", "-seed", "7"})["options"];
  EXPECT_EQ(iterative["seed"], 7);
  const json cleaned = reportOf({"in.ply", "out.ply", "-optimize", "flips", "-smooth", "3",
                                 "-outliers", "2.5", "-attempts", "2"})["options"];
  EXPECT_EQ(cleaned["optimize"], "flips");
  EXPECT_EQ(cleaned["smooth"], 3);
  EXPECT_EQ(cleaned["attempts"], 2);
  EXPECT_EQ(cleaned["outliers"], 2.5);
  EXPECT_EQ(cleaned["outlier_method"], "paper");
}

TEST_F(ReconstructionTool, EachMethodIsTheOneThatWasAskedFor) {
  const json delaunay = reportOf({"in.ply", "out.ply", "-graph", "delaunay"});
  const json knn = reportOf({"in.ply", "out.ply", "-graph", "knn"});
  EXPECT_EQ(knn["graph"]["method"], "knn");
  // 25 neighbours of each of 200 points, and about 6 of each that are Delaunay neighbours.
  EXPECT_GE(knn["graph"]["edges"], 200 * 25 / 2);
  EXPECT_LT(delaunay["graph"]["edges"], 200 * 4);

  const json qhull = reportOf({"in.ply", "qhull.ply", "-hull", "qhull", "-optimize", "none"});
  const json incremental =
      reportOf({"in.ply", "incremental.ply", "-hull", "incremental", "-optimize", "none"});
  EXPECT_EQ(qhull["triangulation"]["method"], "qhull");
  EXPECT_EQ(incremental["triangulation"]["method"], "incremental");
  // The Delaunay triangulation of the same points, which is unique but for the order.
  const auto triangles = [&](const char* file) {
    std::set<std::array<int, 3>> set;
    for (std::array<int, 3> triangle : readPly(directory.file(file)).triangles) {
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                  triangle.end());
      set.insert(triangle);
    }
    return set;
  };
  EXPECT_EQ(triangles("qhull.ply"), triangles("incremental.ply"));
}

// A seed changes the levels, and smoothing keeps a trace of them; a large exponent changes all.
TEST_F(ReconstructionTool, SeedStartsAndExponentReachTheSolver) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(5000));
  const auto sphere_of = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"large.ply", "out.ply", "-sphere", "sphere.ply"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    EXPECT_EQ(runTool(directory, arguments).exit_code, 0);
    return tool_test::readFile(directory.file("sphere.ply"));
  };
  const std::string standard = sphere_of({});
  EXPECT_EQ(sphere_of({"-seed", "1", "-starts", "2", "-exponent", "3"}), standard);
  EXPECT_EQ(sphere_of({"-seed", "4294967295"}), sphere_of({"-seed", "4294967295"}));
  EXPECT_NE(sphere_of({"-seed", "4294967295"}), standard);
  EXPECT_NE(sphere_of({"-exponent", "4"}), standard);
  for (const char* starts : {"1", "5"}) {
    const json report = reportOf({"large.ply", "out.ply", "-starts", starts});
    EXPECT_EQ(report["embedding"]["starts"], std::stoi(starts));
  }
}

TEST_F(ReconstructionTool, ReportTellsTheHierarchy) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(5000));
  const json report = reportOf({"large.ply", "out.ply"});
  const json& levels = report["embedding"]["levels"];
  ASSERT_GE(levels.size(), 2U);
  EXPECT_EQ(levels[0]["nodes"], report["vertices"]);
  EXPECT_EQ(levels[0]["edges"], report["graph"]["edges"]);
  EXPECT_TRUE(levels[0]["coarsening_ratio"].is_null());
  EXPECT_EQ(levels[0]["residual"], report["residual"]);
  EXPECT_GT(levels[0]["sweeps"], 0);
  double nodes = levels[0]["nodes"];
  double edges = levels[0]["edges"];
  for (std::size_t i = 1; i < levels.size(); ++i) {
    EXPECT_LT(levels[i]["nodes"], levels[i - 1]["nodes"]);
    EXPECT_EQ(levels[i]["coarsening_ratio"].get<double>(),
              levels[i - 1]["nodes"].get<double>() / levels[i]["nodes"].get<double>());
    nodes += levels[i]["nodes"].get<double>();
    edges += levels[i]["edges"].get<double>();
  }
  EXPECT_EQ(report["embedding"]["grid_complexity"].get<double>(),
            nodes / levels[0]["nodes"].get<double>());
  EXPECT_EQ(report["embedding"]["operator_complexity"].get<double>(),
            edges / levels[0]["edges"].get<double>());
  EXPECT_GT(levels.back()["newton_iterations"], 0);
  EXPECT_GE(levels.back()["linear_iterations"], levels.back()["newton_iterations"]);
}

TEST_F(ReconstructionTool, PrintsTheHierarchyThatTheReportTells) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(5000));
  const RunResult result = runTool(directory, {"large.ply", "out.ply", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const json& levels = report["embedding"]["levels"];
  EXPECT_NE(result.output.find("Number of levels:    " + std::to_string(levels.size()) + "\n"),
            std::string::npos);
  for (const char* word : {"Operator complexity: 1.", "Grid complexity:     1."}) {
    EXPECT_NE(result.output.find(word), std::string::npos) << word;
  }
  const std::string head = "level      nodes      edges  ratio  sweeps  Newton     CG\n";
  const std::size_t table = result.output.find(head);
  ASSERT_NE(table, std::string::npos);
  std::istringstream lines(result.output.substr(table + head.size()));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.find_first_not_of(" -"), std::string::npos);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::getline(lines, line);
    std::istringstream words(line);
    std::size_t level = 0;
    std::size_t nodes = 0;
    std::size_t edges = 0;
    words >> level >> nodes >> edges;
    EXPECT_EQ(level, i);
    EXPECT_EQ(levels[i]["nodes"], nodes);
    EXPECT_EQ(levels[i]["edges"], edges);
    if (i > 0) {
      double ratio = 0.0;
      words >> ratio;
      // Three digits are printed.
      EXPECT_NEAR(ratio, levels[i]["coarsening_ratio"].get<double>(), 0.01 * ratio);
    }
    int sweeps = 0;
    int newton = 0;
    int linear = 0;
    words >> sweeps >> newton >> linear;
    EXPECT_FALSE(words.fail()) << line;
    EXPECT_EQ(levels[i]["sweeps"], sweeps);
    EXPECT_EQ(levels[i]["newton_iterations"], newton);
    EXPECT_EQ(levels[i]["linear_iterations"], linear);
  }
}

// Without a tolerance nothing is promised; with one the report keeps the promise.
TEST_F(ReconstructionTool, ToleranceMakesTheMultilevelSolverConverge) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(20000));
  const json smoothed = reportOf({"large.ply", "out.ply"});
  EXPECT_EQ(smoothed["stop_reason"], "unfinished");
  EXPECT_GT(smoothed["residual"], 1e-8);
  for (const char* graph : {"delaunay", "knn"}) {
    const json report = reportOf({"large.ply", "out.ply", "-tolerance", "1e-8", "-graph", graph});
    EXPECT_EQ(report["stop_reason"], "converged") << graph;
    EXPECT_EQ(report["converged"], true) << graph;
    EXPECT_LE(report["residual"], 1e-8) << graph;
    EXPECT_EQ(report["options"]["tolerance"], 1e-8);
    EXPECT_EQ(report["iterations"], report["embedding"]["levels"][0]["newton_iterations"]);
    EXPECT_EQ(report["residuals"].size(), report["iterations"].get<std::size_t>() + 1);
    EXPECT_GT(report["iterations"], 0) << graph;
  }
}

// The pull of a barrier is left in the residual: the tool says so.
TEST_F(ReconstructionTool, TellsOfTheBarrierOfWeightsThatHaveNone) {
  for (const char* weights : {"uniform", "inverse"}) {
    const RunResult result = runTool(directory, {"in.ply", "out.ply", "-weights", weights,
                                                 "-tolerance", "1e-8", "-json", "report.json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const json report = json::parse(tool_test::readFile(directory.file("report.json")));
    EXPECT_EQ(report["embedding"]["barrier"], true);
    EXPECT_EQ(report["embedding"]["added_barrier"], false);
    EXPECT_LT(report["embedding"]["centroid_norm"], 0.5);
    EXPECT_NE(result.output.find("the pull of a barrier is left"), std::string::npos);
  }
  const RunResult adaptive = runTool(directory, {"in.ply", "out.ply", "-tolerance", "1e-8"});
  EXPECT_EQ(adaptive.output.find("barrier"), std::string::npos);
}

// Points on a needle have all their neighbours on a line, hence no tangent plane.
TEST_F(ReconstructionTool, NamesPointsOfTheInputWithoutATangentPlane) {
  std::string text = "nan nan nan\n";
  for (const Point& point : cloud.points) {
    text += digits(point) + "\n";
  }
  for (int i = 0; i < 100; ++i) {
    text += digits(Point{0.35F + 0.01F * static_cast<float>(i), 0.0F, 10.0F}) + "\n";
  }
  tool_test::writeFile(directory.file("needle.xyz"), text);
  const RunResult result = runTool(directory, {"needle.xyz", "out.ply", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const auto points = report["graph"]["without_tangent_plane"].get<std::set<int>>();
  EXPECT_EQ(report["graph"]["without_tangent_plane_count"], points.size());
  // The far half of the needle, counted from the line of NaN on.
  for (int i = 251; i < 301; ++i) {
    EXPECT_EQ(points.count(i), 1U) << i;
  }
  EXPECT_EQ(points.count(0), 0U);
  EXPECT_LT(*points.rbegin(), 301);
  EXPECT_NE(result.output.find("tangent plane       missing at " + std::to_string(points.size()) +
                               " points"),
            std::string::npos);
  const json knn = reportOf({"needle.xyz", "out.ply", "-graph", "knn"});
  EXPECT_EQ(knn["graph"]["without_tangent_plane_count"], 0);
}

TEST_F(ReconstructionTool, ReportNamesBridgesByPointsOfTheInput) {
  std::string text = "nan nan nan\n";
  for (const float shift : {0.0F, 5.0F}) {
    for (const Point& point : cloud.points) {
      text += digits(Point{point[0] + shift, point[1], point[2]}) + "\n";
    }
  }
  tool_test::writeFile(directory.file("pair.xyz"), text);
  const json report = reportOf({"pair.xyz", "out.ply", "-graph", "knn"});
  EXPECT_EQ(report["graph"]["components"], 2);
  ASSERT_EQ(report["graph"]["bridges"].size(), 1U);
  const json& bridge = report["graph"]["bridges"][0];
  const int low = std::min(bridge["from"].get<int>(), bridge["to"].get<int>());
  const int high = std::max(bridge["from"].get<int>(), bridge["to"].get<int>());
  ASSERT_GE(low, 1);
  ASSERT_GE(high, 201);
  ASSERT_LT(low, 201);
  const Point& from = cloud.points[static_cast<std::size_t>(low - 1)];
  const Point& to = cloud.points[static_cast<std::size_t>(high - 201)];
  EXPECT_NEAR(bridge["length"].get<double>(),
              std::hypot(to[0] + 5.0F - from[0], to[1] - from[1], to[2] - from[2]), 1e-5);
}

TEST_F(ReconstructionTool, OptionsReachTheLibraryInEveryNotation) {
  const std::vector<std::vector<std::string>> notations = {
      {"-k", "7", "-weights", "inverse", "in.ply", "-iterations", "3", "out.ply", "-lambda", "0.25",
       "-solver", "iterative"},
      {"--k", "7", "in.ply", "out.ply", "--weights", "inverse", "--iterations", "3", "--lambda",
       "0.25", "--solver", "iterative"},
      {"in.ply", "--k=7", "--weights=inverse", "out.ply", "--iterations=3", "--lambda=0.25",
       "--solver=iterative"},
      {"in.ply", "out.ply", "-k=7", "-weights=inverse", "-iterations=3", "-lambda=+.25",
       "-solver=iterative"},
  };
  std::set<std::string> meshes;
  for (const auto& arguments : notations) {
    const json report = reportOf(arguments);
    EXPECT_EQ(report["options"]["k"], 7);
    EXPECT_EQ(report["options"]["weights"], "inverse");
    EXPECT_EQ(report["options"]["lambda"], 0.25);
    EXPECT_EQ(report["iterations"], 3);
    EXPECT_EQ(report["input"], "in.ply");
    meshes.insert(tool_test::readFile(directory.file("out.ply")));
  }
  EXPECT_EQ(meshes.size(), 1U);
}

TEST_F(ReconstructionTool, FilesAreToldByTheirExtension) {
  writeCloud(directory.file("in.pcd"), "in.pcd", cloud);
  EXPECT_EQ(runTool(directory, {"-k", "9", "out.stl", "in.pcd"}).exit_code, 0);
  EXPECT_EQ(runTool(directory, {"in.ply", "OUT.VTK"}).exit_code, 0);
  EXPECT_EQ(directory.listing().count("out.stl"), 1U);
  EXPECT_EQ(directory.listing().count("OUT.VTK"), 1U);
}

TEST_F(ReconstructionTool, NeverTakesTheFirstOfTwoPossibleInputsForTheOutput) {
  writeCloud(directory.file("in.pcd"), "in.pcd", cloud);
  const auto before = directory.listing();
  EXPECT_EQ(runTool(directory, {"in.ply", "in.pcd"}).exit_code, 2);
  EXPECT_EQ(directory.listing(), before);
}

TEST_F(ReconstructionTool, StandardOutputIsTheReportAlone) {
  const RunResult result = runTool(directory, {"in.ply", "out.ply", "-json", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  EXPECT_TRUE(json::accept(result.output));
}

TEST_F(ReconstructionTool, TellsWhenSinglePrecisionMovesThePoints) {
  const auto warned = [&](double offset) {
    std::string text;
    for (const Point& point : cloud.points) {
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "%.17g %.17g %.17g\n", offset + point[0],
                    offset + point[1], offset + point[2]);
      text += line.data();
    }
    tool_test::writeFile(directory.file("offset.xyz"), text);
    const json report = reportOf({"offset.xyz", "out.ply"});
    return report["warnings"].dump().find("rounded to single precision") != std::string::npos;
  };
  EXPECT_FALSE(warned(0.0));
  EXPECT_FALSE(warned(0.1));  // 17 digits, but the lost ones do not matter
  EXPECT_TRUE(warned(5e5));   // as in UTM coordinates
}

// Sanitizers take address space and memory of their own.
#ifndef SPHERICAL_PARAM_SANITIZED
// A thread takes address space; OpenMP ends the process where one cannot be had.
TEST_F(ReconstructionTool, AbsurdNumbersOfThreadsAreNotStarted) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(20000));
  RunOptions options;
  options.directory = directory.path();
  options.address_space_limit = std::size_t{3} << 30;
  const RunResult result =
      run(RECONSTRUCTION_TOOL, {"large.ply", "out.ply", "-threads", "1024"}, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(directory.listing().count("out.ply"), 1U);
}

TEST_F(ReconstructionTool, ReportedMemoryIsThatOfTheToolAlone) {
  // What the process that starts the tool has in use is no part of it.
  const std::vector<char> large(400U << 20U, 'x');
  ASSERT_EQ(large.back(), 'x');
  writeCloud(directory.file("in.ply"), "in.ply", ellipsoid(200));
  EXPECT_LT(reportOf({"in.ply", "out.ply"})["peak_memory_bytes"], 300 << 20);
}

// Besides what the process takes without any.
TEST_F(ReconstructionTool, TakesLessThanTwoKilobytesAPointOrFourToConverge) {
  struct Case {
    std::vector<std::string> options;
    double limit;  ///< bytes a point
  };
  const std::vector<Case> cases = {
      {{}, 2048.0},
      {{"-graph", "knn", "-solver", "iterative", "-iterations", "3", "-hull", "qhull"}, 2048.0},
      {{"-tolerance", "1e-8"}, 4096.0},
      {{"-graph", "knn", "-tolerance", "1e-8"}, 4096.0}};
  for (const Case& test : cases) {
    const auto peak = [&](int points) {
      writeCloud(directory.file("many.ply"), "in.ply", ellipsoid(points));
      std::vector<std::string> arguments = {"many.ply", "out.ply"};
      arguments.insert(arguments.end(), test.options.begin(), test.options.end());
      return reportOf(arguments)["peak_memory_bytes"].get<double>();
    };
    EXPECT_LT((peak(100000) - peak(200)) / 100000.0, test.limit)
        << testing::PrintToString(test.options);
  }
}
#endif

TEST_F(ReconstructionTool, QuietPrintsNothing) {
  const RunResult result = runTool(directory, {"in.ply", "out.ply", "-quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output + result.errors, "");
  EXPECT_EQ(directory.listing().count("out.ply"), 1U);
}

TEST_F(ReconstructionTool, HelpAndVersionSucceed) {
  for (const char* option : {"-h", "--h", "-help", "--help"}) {
    const RunResult result = runTool(directory, {option});
    EXPECT_EQ(result.exit_code, 0);
    for (const char* line :
         {"-graph NAME", "-k N", "-solver NAME", "-weights NAME", "-exponent X", "-tolerance X",
          "-lambda X", "-iterations N", "-stagnation N", "-starts N", "-seed N", "-hull NAME",
          "-optimize NAME", "-attempts N", "-smooth N", "-outliers SIGMA", "-outlier-method NAME",
          "-strict", "-threads N"}) {
      EXPECT_NE(result.output.find(std::string("\n  ") + line), std::string::npos) << line;
    }
  }
  for (const char* option : {"-version", "--version"}) {
    const RunResult result = runTool(directory, {option});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.output.rfind("pcl_spherical_param_reconstruction ", 0), 0U);
  }
}

TEST_F(ReconstructionTool, PrintsStagesInPlainLinesAndTheVerdict) {
  const RunResult result = runTool(directory, {"in.ply", "out.ply"});
  EXPECT_EQ(result.output.find_first_of("\r\033"), std::string::npos);
  for (const char* word : {"read",
                           "neighbors",
                           "graph",
                           "embedding",
                           "triangulation",
                           "optimization",
                           "check",
                           "write",
                           "points              200",
                           "used                200",
                           "graph edges         ",

                           "local Delaunay      ",
                           "tangent plane       missing at 0 points",
                           "starts tried        2 (0 collapsed)",
                           "triangles           396",
                           "closed              yes",
                           "manifold            yes",
                           "oriented            yes",
                           "genus               0",
                           "residual",
                           "hull vertices       200 (0 put back, 0 coincident)",
                           "converged           not asked for",
                           "optimised           full, energy ",
                           "self-intersections  0",
                           "looks like          a closed genus-0 surface.",
                           "volume              ",
                           "area                ",
                           "bounding box        ",
                           "centroid            "}) {
    EXPECT_NE(result.output.find(std::string("\n  ") + word), std::string::npos) << word;
  }
  EXPECT_NE(result.output.find(" (1 component, 0 bridges)\n"), std::string::npos);
}

// --------------------------------------------------------------------------- quality of the mesh

Eigen::Vector3d position(const Point& point) {
  return Eigen::Vector3f(point.data()).cast<double>();
}

Eigen::Vector3d vectorOf(const json& values) {
  return {values[0].get<double>(), values[1].get<double>(), values[2].get<double>()};
}

spherical_param::Positions positionsOf(const Mesh& mesh) {
  spherical_param::Positions positions(3, static_cast<Eigen::Index>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = position(mesh.points[i]);
  }
  return positions;
}

/// Pairs of triangles of a written mesh that intersect.
std::vector<std::array<int, 2>> selfIntersections(const Mesh& mesh) {
  spherical_param::Triangles triangles(3, static_cast<Eigen::Index>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    triangles.col(static_cast<Eigen::Index>(t)) = Eigen::Vector3i(mesh.triangles[t].data());
  }
  return spherical_param::findSelfIntersections(positionsOf(mesh), triangles);
}

/// The third corner of the triangle at the left of each directed edge.
std::map<std::pair<int, int>, int> cornersOfEdges(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> corners;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      corners[{triangle[c], triangle[(c + 1) % 3]}] = triangle[(c + 2) % 3];
    }
  }
  return corners;
}

/// Edges of a triangulation of the unit sphere that are not those of the convex hull.
int edgesOffTheHull(const Mesh& sphere) {
  const spherical_param::Positions p = positionsOf(sphere);
  const auto corners = cornersOfEdges(sphere);
  int count = 0;
  for (const auto& [edge, corner] : corners) {
    const auto [a, b] = edge;
    Eigen::Matrix3d sides;
    sides << p.col(b) - p.col(a), p.col(corner) - p.col(a), p.col(corners.at({b, a})) - p.col(a);
    // The rounding of floats, in the volume of a tetrahedron whose sides are below 1.
    count += a < b && sides.determinant() > 1e-6 ? 1 : 0;
  }
  return count;
}

double volumeOf(const Mesh& mesh) {
  const spherical_param::Positions p = positionsOf(mesh);
  double volume = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    // About a point of the mesh, where the sum loses no digits.
    volume += (p.col(a) - p.col(0)).dot((p.col(b) - p.col(0)).cross(p.col(c) - p.col(0))) / 6.0;
  }
  return volume;
}

/// A tool that has generated scans at hand.
class QualityOfTheMesh : public ReconstructionTool {
protected:
  void scan(const std::vector<std::string>& arguments) {
    RunOptions options;
    options.directory = directory.path();
    ASSERT_EQ(run(SCAN_TOOL, arguments, options).exit_code, 0);
  }

  Mesh meshFile(const std::string& name) const { return readPly(directory.file(name)); }
};

/// What the parts of a report say about each other.
void expectConsistency(const json& report, const Mesh& mesh) {
  const json& pairs = report["self_intersecting_pairs"];
  const auto count = report["self_intersections"].get<std::size_t>();
  EXPECT_EQ(pairs.size(), std::min<std::size_t>(count, 1000));
  std::array<int, 2> last = {-1, -1};
  for (const json& pair : pairs) {
    const auto [low, high] = pair.get<std::array<int, 2>>();
    EXPECT_LT(low, high);
    EXPECT_LT(high, static_cast<int>(mesh.triangles.size()));
    EXPECT_LT(last, (std::array<int, 2>{low, high}));
    last = {low, high};
  }
  int chosen = 0;
  for (const json& attempt : report["attempts"]) {
    chosen += attempt["chosen"].get<bool>() ? 1 : 0;
  }
  EXPECT_EQ(chosen, 1);
  EXPECT_LE(report["attempts"].size(), report["options"]["attempts"].get<std::size_t>());
  EXPECT_EQ(report["measures"]["volume"], report["volume"]);
  EXPECT_EQ(report["measures"]["area"], report["area"]);
  const json& diagnosis = report["diagnosis"];
  EXPECT_EQ(diagnosis["looks_closed_genus0"].get<bool>(), diagnosis["kind"] == "closed genus 0");
  for (const char* kind : {"lids", "handles", "bridges"}) {
    for (const json& finding : diagnosis[kind]) {
      EXPECT_EQ(finding["location"].size(), 3U);
      EXPECT_GT(finding["size"], 0.0);
      EXPECT_FALSE(finding["vertices"].empty());
      for (const json& vertex : finding["vertices"]) {
        EXPECT_GE(vertex, 0);
        EXPECT_LT(vertex, report["points"]);
      }
    }
  }
}

TEST_F(QualityOfTheMesh, GeneratedObjectsAreMeshedWithoutSelfIntersections) {
  for (const char* shape : {"head", "bird", "hand", "ellipsoid"}) {
    scan({shape, "scan.ply", "-points", "3000"});
    const json report = reportOf({"scan.ply", "out.ply"});
    const Mesh mesh = meshFile("out.ply");
    expectConsistency(report, mesh);
    EXPECT_EQ(report["self_intersections"], 0) << shape;
    EXPECT_TRUE(selfIntersections(mesh).empty()) << shape;
    EXPECT_EQ(report["diagnosis"]["kind"], "closed genus 0") << shape;
    for (const char* finding : {"lids", "handles", "bridges"}) {
      EXPECT_TRUE(report["diagnosis"][finding].empty()) << shape << " " << finding;
    }
    EXPECT_EQ(report["attempts"].size(), 1U) << shape;
  }
}

TEST_F(QualityOfTheMesh, AnOpeningIsFoundWhereItIs) {
  scan({"bowl", "scan.ply", "-points", "3000"});
  const json report = reportOf({"scan.ply", "out.ply"});
  expectConsistency(report, meshFile("out.ply"));
  const json& diagnosis = report["diagnosis"];
  EXPECT_EQ(diagnosis["kind"], "open");
  ASSERT_EQ(diagnosis["lids"].size(), 1U);
  const json& lid = diagnosis["lids"][0];
  EXPECT_EQ(lid["cause"], "open");
  // A sphere of radius 0.5 cut at z = 0.15, sampled every 0.035.
  EXPECT_LT((vectorOf(lid["location"]) - Eigen::Vector3d(0.0, 0.0, 0.15)).norm(), 0.07);
  EXPECT_NEAR(lid["size"].get<double>(), 2.0 * std::sqrt(0.25 - 0.15 * 0.15), 0.1);
  const Mesh input = meshFile("scan.ply");
  for (const json& vertex : lid["vertices"]) {
    EXPECT_NEAR(static_cast<double>(input.points[vertex.get<std::size_t>()][2]), 0.15, 0.07);
  }
}

TEST_F(QualityOfTheMesh, TwoPartsAreFoundWithTheGapBetweenThem) {
  scan({"pair", "scan.ply", "-points", "2000"});
  const json report = reportOf({"scan.ply", "out.ply"});
  expectConsistency(report, meshFile("out.ply"));
  const json& diagnosis = report["diagnosis"];
  EXPECT_EQ(diagnosis["kind"], "several parts");
  ASSERT_EQ(diagnosis["bridges"].size(), 1U);
  const json& bridge = diagnosis["bridges"][0];
  EXPECT_EQ(bridge["points"].get<int>() + bridge["other_points"].get<int>(), 2000);
  EXPECT_NEAR(bridge["points"].get<double>(), 1000.0, 50.0);
  // Spheres of radius 0.2 at x = -0.3 and 0.3: a gap of 0.2 around the origin.
  EXPECT_NEAR(bridge["size"].get<double>(), 0.2, 0.02);
  EXPECT_LT(vectorOf(bridge["location"]).norm(), 0.05);
}

TEST_F(QualityOfTheMesh, LoopsOfALidArePathsAlongTheMeshWithItsLength) {
  scan({"holed", "scan.ply", "-points", "3000"});
  const json report = reportOf({"scan.ply", "out.ply"});
  const json& diagnosis = report["diagnosis"];
  EXPECT_EQ(diagnosis["kind"], "open");
  EXPECT_TRUE(diagnosis["genus"].is_null());
  ASSERT_EQ(diagnosis["lids"].size(), 4U);
  // All points are vertices, in their order.
  const Mesh mesh = meshFile("out.ply");
  const spherical_param::Positions points = positionsOf(mesh);
  const auto corners = cornersOfEdges(mesh);
  for (const json& lid : diagnosis["lids"]) {
    ASSERT_EQ(lid["loops"].size(), 1U);
    const auto loop = lid["loops"][0].get<std::vector<int>>();
    double length = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int next = loop[(i + 1) % loop.size()];
      EXPECT_EQ(corners.count({loop[i], next}), 1U);
      length += (points.col(loop[i]) - points.col(next)).norm();
    }
    EXPECT_NEAR(length, lid["boundary_length"].get<double>(), 1e-9);
  }
}

TEST_F(QualityOfTheMesh, StrictMakesWarningsAFailureAndWritesTheFilesAllTheSame) {
  scan({"holed", "scan.ply", "-points", "2000"});
  const RunResult lax = runTool(directory, {"scan.ply", "lax.ply", "-quiet"});
  EXPECT_EQ(lax.exit_code, 0);
  EXPECT_EQ(lax.errors, "");
  const RunResult strict = runTool(directory, {"scan.ply", "out.ply", "-strict", "-quiet",
                                               "-sphere", "sphere.ply", "-json", "report.json"});
  EXPECT_EQ(strict.exit_code, 1);
  const std::vector<std::string> lines = strict.errorLines();
  ASSERT_EQ(lines.size(), 2U) << strict.errors;
  EXPECT_NE(lines[0].find("4 openings"), std::string::npos) << lines[0];
  EXPECT_EQ(lines[1].rfind("  remedy: the files were made all the same", 0), 0U) << lines[1];
  EXPECT_EQ(tool_test::readFile(directory.file("out.ply")),
            tool_test::readFile(directory.file("lax.ply")));
  EXPECT_EQ(directory.listing().count("sphere.ply"), 1U);
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  EXPECT_EQ(report["options"]["strict"], true);
  // Every warning is in the message.
  for (const json& warning : report["warnings"]) {
    EXPECT_NE(lines[0].find(warning.get<std::string>()), std::string::npos) << warning;
  }
  // Where there is none, nothing changes.
  const RunResult clean = runTool(directory, {"in.ply", "out.ply", "-strict", "-quiet"});
  EXPECT_EQ(clean.exit_code, 0) << clean.errors;
  EXPECT_EQ(clean.output + clean.errors, "");
}

TEST_F(QualityOfTheMesh, HandlesAreCounted) {
  scan({"double_torus", "scan.ply", "-points", "3000"});
  const json diagnosis = reportOf({"scan.ply", "out.ply"})["diagnosis"];
  EXPECT_EQ(diagnosis["kind"], "handles");
  EXPECT_EQ(diagnosis["genus"], 2);
  EXPECT_NE(diagnosis["summary"].get<std::string>().find("2 handles"), std::string::npos);
}

TEST_F(QualityOfTheMesh, AHandleIsFound) {
  scan({"torus", "scan.ply", "-points", "3000"});
  const json report = reportOf({"scan.ply", "out.ply"});
  expectConsistency(report, meshFile("out.ply"));
  const json& diagnosis = report["diagnosis"];
  EXPECT_EQ(diagnosis["looks_closed_genus0"], false);
  EXPECT_EQ(diagnosis["kind"], "handles");
  ASSERT_FALSE(diagnosis["handles"].empty());
  // A tube of radius 0.14 around a circle of radius 0.36: the cut goes through the tube, or fills
  // the hole; a few edges beyond either.
  const Eigen::Vector3d place = vectorOf(diagnosis["handles"][0]["location"]);
  EXPECT_LT(place.head<2>().norm(), 0.5);
  EXPECT_LT(std::abs(place.z()), 0.14);
}

TEST_F(QualityOfTheMesh, WithoutOptimizationTheMeshIsThatOfTheSphere) {
  scan({"hand", "scan.ply", "-points", "3000"});
  const std::vector<std::string> raw_run = {"scan.ply",  "raw.ply", "-sphere",   "sphere.ply",
                                            "-optimize", "none",    "-attempts", "1"};
  const json raw = reportOf(raw_run);
  expectConsistency(raw, meshFile("raw.ply"));
  EXPECT_EQ(raw["optimization"]["method"], "none");
  EXPECT_TRUE(raw["optimization"]["phases"].empty());
  EXPECT_EQ(raw["attempts"].size(), 1U);
  EXPECT_EQ(edgesOffTheHull(meshFile("sphere.ply")), 0);
  EXPECT_EQ(meshFile("sphere.ply").triangles, meshFile("raw.ply").triangles);

  const json full = reportOf({"scan.ply", "full.ply", "-sphere", "sphere.ply"});
  EXPECT_GT(edgesOffTheHull(meshFile("sphere.ply")), 0);
  const json flips = reportOf({"scan.ply", "flips.ply", "-optimize", "flips"});
  EXPECT_LE(full["self_intersections"], flips["self_intersections"]);
  EXPECT_LT(flips["optimization"]["energy"], flips["optimization"]["phases"][0]["energy_before"]);
  for (const json& phase : flips["optimization"]["phases"]) {
    EXPECT_TRUE(phase["name"] == "flips" || phase["name"] == "polish") << phase["name"];
  }
  // The points stay where they are, whatever the mesh.
  for (const char* name : {"raw.ply", "full.ply", "flips.ply"}) {
    EXPECT_EQ(meshFile(name).points, meshFile("scan.ply").points) << name;
    expectSphere(meshFile(name));
  }
}

TEST_F(QualityOfTheMesh, SelfIntersectionsOfTheReportAreThoseOfTheMesh) {
  scan({"hand", "scan.ply", "-points", "4000", "-noise", "1"});
  const json report = reportOf({"scan.ply", "out.ply", "-optimize", "none", "-attempts", "1"});
  const Mesh mesh = meshFile("out.ply");
  expectConsistency(report, mesh);
  const auto pairs = selfIntersections(mesh);
  // More than are listed.
  ASSERT_GT(pairs.size(), 1000U);
  EXPECT_EQ(report["self_intersections"], pairs.size());
  for (std::size_t i = 0; i < report["self_intersecting_pairs"].size(); ++i) {
    EXPECT_EQ(report["self_intersecting_pairs"][i], json(pairs[i]));
  }
}

// A cloud so coarse that the first mesh may intersect itself, and so few points that they show no
// surface, some of which have no other mesh.
TEST_F(QualityOfTheMesh, AttemptsAreABudgetThatIsSpentWhereTheMeshIntersectsItself) {
  scan({"hand", "coarse.ply", "-points", "300"});
  std::vector<std::string> files{"coarse.ply"};
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::ostringstream text;
    for (int i = 0; i < (seed % 2 == 0 ? 8 : 16); ++i) {
      text << uniform(random) << ' ' << uniform(random) << ' ' << uniform(random) << '\n';
    }
    files.push_back("random" + std::to_string(seed) + ".xyz");
    tool_test::writeFile(directory.file(files.back()), text.str());
  }
  std::size_t most = 0;
  for (const std::string& file : files) {
    for (const std::size_t budget : {1U, 3U}) {
      const RunResult result = runTool(directory, {file, "out.ply", "-attempts",
                                                   std::to_string(budget), "-json", "report.json"});
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      const json report = json::parse(tool_test::readFile(directory.file("report.json")));
      expectConsistency(report, meshFile("out.ply"));
      const json& attempts = report["attempts"];
      ASSERT_FALSE(attempts.empty());
      ASSERT_LE(attempts.size(), budget);
      most = std::max(most, attempts.size());
      for (std::size_t i = 0; i < attempts.size(); ++i) {
        const json& attempt = attempts[i];
        for (const json& other : attempts) {
          EXPECT_TRUE(!attempt["chosen"].get<bool>() ||
                      attempt["self_intersections"] <= other["self_intersections"]);
        }
        const std::string line = "\n  attempt " + std::to_string(i + 1) + "           ";
        EXPECT_EQ(result.output.find(line) != std::string::npos, attempts.size() > 1);
        // Nothing is tried after a mesh that does not intersect itself.
        EXPECT_TRUE(attempt["self_intersections"] > 0 || i + 1 == attempts.size());
      }
    }
  }
  EXPECT_GT(most, 1U);
}

// Equation (1) of optimizeMesh(), by the book.
TEST_F(QualityOfTheMesh, EnergyOfTheReportIsThatOfTheMesh) {
  scan({"bird", "scan.ply", "-points", "2000"});
  const json report = reportOf({"scan.ply", "out.ply"});
  ASSERT_EQ(report["optimization"]["noisy"], false);
  const Mesh mesh = meshFile("out.ply");
  const spherical_param::Positions p = positionsOf(mesh);
  double energy = 0.0;
  const auto corners = cornersOfEdges(mesh);
  for (const auto& [edge, corner] : corners) {
    const auto [a, b] = edge;
    if (a < b) {
      const Eigen::Vector3d side = p.col(b) - p.col(a);
      const Eigen::Vector3d n = side.cross(p.col(corner) - p.col(a));
      const Eigen::Vector3d m = (p.col(corners.at({b, a})) - p.col(a)).cross(side);
      energy += side.norm() * std::atan2(n.cross(m).norm(), n.dot(m));
    }
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const double ab = (p.col(b) - p.col(a)).norm();
    const double bc = (p.col(c) - p.col(b)).norm();
    const double ca = (p.col(a) - p.col(c)).norm();
    const double twice_area = (p.col(b) - p.col(a)).cross(p.col(c) - p.col(a)).norm();
    energy += 0.3 * std::min(ab * bc * ca / (2.0 * twice_area), 4.0 * std::max({ab, bc, ca}));
  }
  // Sums of some 10,000 terms in another order.
  EXPECT_NEAR(report["optimization"]["energy"].get<double>(), energy, 1e-9 * energy);
}

TEST_F(QualityOfTheMesh, PrintsThePhasesThatTheReportTells) {
  scan({"hand", "scan.ply", "-points", "3000"});
  const RunResult result = runTool(directory, {"scan.ply", "out.ply", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const json& phases = report["optimization"]["phases"];
  const std::string head = "phase          tried      moves       energy  self-int.  seconds\n";
  const std::size_t table = result.output.find(head);
  ASSERT_NE(table, std::string::npos);
  std::istringstream lines(result.output.substr(table + head.size()));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.find_first_not_of(" -"), std::string::npos);
  for (const json& phase : phases) {
    std::getline(lines, line);
    std::istringstream words(line);
    std::string name;
    std::size_t tried = 0;
    std::size_t moves = 0;
    double energy = 0.0;
    words >> name >> tried >> moves >> energy;
    EXPECT_EQ(phase["name"], name);
    EXPECT_EQ(phase["tried"], tried);
    EXPECT_EQ(phase["moves"], moves);
    // Six digits are printed.
    EXPECT_NEAR(energy, phase["energy"].get<double>(), 1e-5 * energy);
    if (!phase["self_intersections"].is_null()) {
      std::size_t self_intersections = 0;
      words >> self_intersections;
      EXPECT_EQ(phase["self_intersections"], self_intersections);
    }
    double seconds = 0.0;
    words >> seconds;
    EXPECT_FALSE(words.fail()) << line;
    std::string rest;
    EXPECT_FALSE(words >> rest) << line;
  }
  EXPECT_EQ(phases.back()["energy"].is_number_float(), true);
}

TEST_F(QualityOfTheMesh, MeasuresAreThoseOfTheMesh) {
  scan({"animal", "scan.ply", "-points", "2000"});
  const json measures = reportOf({"scan.ply", "out.ply"})["measures"];
  const Mesh mesh = meshFile("out.ply");
  const spherical_param::Positions p = positionsOf(mesh);
  double area = 0.0;
  double length = 0.0;
  double volume = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {
    area += (p.col(b) - p.col(a)).cross(p.col(c) - p.col(a)).norm() / 2.0;
    length +=
        (p.col(b) - p.col(a)).norm() + (p.col(c) - p.col(b)).norm() + (p.col(a) - p.col(c)).norm();
    Eigen::Matrix3d corners;
    corners << p.col(a), p.col(b), p.col(c);
    // A tetrahedron with the origin: its moments about it.
    const double part = corners.determinant() / 6.0;
    const Eigen::Vector3d sum = corners.rowwise().sum();
    volume += part;
    moment += part / 4.0 * sum;
    second += part / 20.0 * (sum * sum.transpose() + corners * corners.transpose());
  }
  const Eigen::Vector3d centroid = moment / volume;
  second -= volume * centroid * centroid.transpose();
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  // Sums of 4,000 terms in another order, of a cloud of extent 1.
  EXPECT_NEAR(measures["volume"].get<double>(), volume, 1e-12);
  EXPECT_NEAR(measures["area"].get<double>(), area, 1e-12);
  const double edges = 1.5 * static_cast<double>(mesh.triangles.size());
  EXPECT_NEAR(measures["mean_edge_length"].get<double>(), length / 2.0 / edges, 1e-12);
  EXPECT_LT((vectorOf(measures["centroid"]) - centroid).norm(), 1e-12);
  EXPECT_EQ(vectorOf(measures["bounding_box"]["min"]), p.rowwise().minCoeff());
  EXPECT_EQ(vectorOf(measures["bounding_box"]["max"]), p.rowwise().maxCoeff());
  for (std::size_t row = 0; row < 3; ++row) {
    const Eigen::Vector3d expected = inertia.row(static_cast<Eigen::Index>(row));
    EXPECT_LT((vectorOf(measures["inertia"][row]) - expected).norm(), 1e-12);
  }
}

TEST_F(QualityOfTheMesh, SmoothingMovesThePointsAloneAndTellsHowFar) {
  // The scan tool writes no colours.
  Mesh noisy = ellipsoid(2000);
  for (std::size_t i = 0; i < noisy.points.size(); ++i) {
    for (float& coordinate : noisy.points[i]) {
      coordinate += i % 3 == 0 ? 0.001F : -0.001F;
    }
  }
  writeCloud(directory.file("noisy.ply"), "in.ply", noisy);
  const RunResult result =
      runTool(directory, {"noisy.ply", "out.ply", "-smooth", "3", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const Mesh mesh = meshFile("out.ply");
  EXPECT_EQ(mesh.colors, noisy.colors);
  EXPECT_EQ(mesh.normals, noisy.normals);
  EXPECT_EQ(mesh.triangles.size(), 2 * noisy.points.size() - 4);
  expectSphere(mesh);
  ASSERT_EQ(mesh.points.size(), noisy.points.size());
  const json& smoothing = report["smoothing"];
  EXPECT_EQ(smoothing["steps"], 3);
  EXPECT_EQ(smoothing["method"], "biharmonic");
  double largest = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const double distance = (position(mesh.points[i]) - position(noisy.points[i])).norm();
    largest = std::max(largest, distance);
    sum += distance;
    squares += distance * distance;
  }
  const auto count = static_cast<double>(mesh.points.size());
  EXPECT_GT(largest, 0.001);
  // Coordinates near 10 are written in single precision.
  constexpr double rounding = 2e-6;
  EXPECT_NEAR(smoothing["max_displacement"].get<double>(), largest, rounding);
  EXPECT_NEAR(smoothing["mean_displacement"].get<double>(), sum / count, rounding);
  EXPECT_NEAR(smoothing["rms_displacement"].get<double>(), std::sqrt(squares / count), rounding);
  EXPECT_NEAR(smoothing["volume_after"].get<double>(), volumeOf(mesh), 1e-6);
  Mesh unsmoothed = mesh;
  unsmoothed.points = noisy.points;
  EXPECT_NEAR(smoothing["volume_before"].get<double>(), volumeOf(unsmoothed), 1e-9);
  EXPECT_EQ(smoothing["self_intersections"], selfIntersections(mesh).size());
  // All else of the report is about the points of the input.
  EXPECT_EQ(report["self_intersections"], selfIntersections(unsmoothed).size());
  EXPECT_NEAR(report["volume"].get<double>(), volumeOf(unsmoothed), 1e-9);
  for (const char* line : {"\n  smooth              3\n", "\n  smoothed            3 steps, "}) {
    EXPECT_NE(result.output.find(line), std::string::npos) << line;
  }
}

TEST_F(QualityOfTheMesh, ANoisyScanThatIsSmoothedDoesNotIntersectItself) {
  for (const char* shape : {"head", "ellipsoid", "bird"}) {
    scan({shape, "scan.ply", "-points", "3000", "-noise", "0.5"});
    const json report = reportOf({"scan.ply", "out.ply", "-smooth", "5"});
    expectConsistency(report, meshFile("out.ply"));
    EXPECT_EQ(report["optimization"]["noisy"], true) << shape;
    EXPECT_EQ(report["smoothing"]["self_intersections"], 0) << shape;
    EXPECT_TRUE(selfIntersections(meshFile("out.ply")).empty()) << shape;
  }
}

// At noise as large as the distance of neighbours nothing is promised, but what is left is told.
TEST_F(QualityOfTheMesh, StrongNoiseIsToldAndSmoothingLeavesFewSelfIntersections) {
  scan({"head", "scan.ply", "-points", "3000", "-noise", "1"});
  const RunResult result =
      runTool(directory, {"scan.ply", "out.ply", "-smooth", "5", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const Mesh mesh = meshFile("out.ply");
  expectConsistency(report, mesh);
  EXPECT_EQ(report["optimization"]["noisy"], true);
  const int steps = report["optimization"]["noise_steps"];
  EXPECT_NE(result.output.find("noisy: on positions after " + std::to_string(steps) + " steps"),
            std::string::npos);
  const std::size_t left = report["smoothing"]["self_intersections"];
  EXPECT_LT(left, report["self_intersections"].get<std::size_t>());
  // The points are rounded to single precision when they are written.
  EXPECT_NEAR(static_cast<double>(selfIntersections(mesh).size()), static_cast<double>(left), 2.0);
}

/// Outliers among the points of an ellipsoid, with repeated ones and some that are not finite.
TEST_F(QualityOfTheMesh, OutliersAreLeftOutAndListed) {
  const Mesh surface = ellipsoid(1500);
  std::string text = "nan 0 0\n";
  int line = 1;
  std::vector<int> expected;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    text += digits(surface.points[i]) + "\n";
    ++line;
    if (i % 300 == 17) {
      // Three times the ellipsoid's size away, each at a place of its own, and twice there.
      Point outlier = surface.points[i];
      outlier[expected.size() % 3] += expected.size() % 4 == 0 ? 1.0F : -1.0F;
      text += digits(outlier) + "\n" + digits(outlier) + "\n";
      expected.insert(expected.end(), {line, line + 1});
      line += 2;
    }
  }
  tool_test::writeFile(directory.file("outliers.xyz"), text);
  for (const char* method : {"paper", "statistical"}) {
    const RunResult result =
        runTool(directory, {"outliers.xyz", "out.ply", "-outliers", "5", "-outlier-method", method,
                            "-json", "report.json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const json report = json::parse(tool_test::readFile(directory.file("report.json")));
    const json& outliers = report["outliers"];
    EXPECT_EQ(outliers["method"], method);
    EXPECT_EQ(outliers["sigma"], 5.0);
    EXPECT_EQ(outliers["count"], expected.size());
    EXPECT_EQ(outliers["indices"], json(expected)) << method;
    EXPECT_EQ(outliers["threshold"].is_number_float(), std::string(method) == "paper");
    EXPECT_EQ(report["points"], line);
    EXPECT_EQ(report["vertices"], surface.points.size());
    EXPECT_EQ(report["ignored_points"], 1);
    EXPECT_EQ(report["duplicates"], 0);
    EXPECT_EQ(report["stages"][1]["name"], "outliers");
    const Mesh mesh = meshFile("out.ply");
    EXPECT_EQ(mesh.points, surface.points);
    expectSphere(mesh);
    EXPECT_NE(result.output.find("\n  outliers            10 left out\n"), std::string::npos);
  }
  // Without the option they are points like all others.
  EXPECT_EQ(reportOf({"outliers.xyz", "out.ply"})["vertices"],
            surface.points.size() + expected.size() / 2);
}

TEST_F(QualityOfTheMesh, FindingsNamePointsOfTheInputBehindThoseLeftOut) {
  // Outliers and points that are not finite before all others shift the vertices.
  scan({"bowl", "scan.xyz", "-points", "2000"});
  const std::string surface = tool_test::readFile(directory.file("scan.xyz"));
  tool_test::writeFile(directory.file("plain.xyz"), surface);
  tool_test::writeFile(directory.file("shifted.xyz"), "nan 0 0\n5 5 5\n5 5 5\n" + surface);
  const json plain = reportOf({"plain.xyz", "out.ply", "-outliers", "6"});
  const json shifted = reportOf({"shifted.xyz", "out.ply", "-outliers", "6"});
  EXPECT_TRUE(plain["outliers"]["indices"].empty());
  EXPECT_EQ(shifted["outliers"]["indices"], json({1, 2}));
  ASSERT_EQ(plain["diagnosis"]["lids"].size(), 1U);
  ASSERT_EQ(shifted["diagnosis"]["lids"].size(), 1U);
  auto vertices = plain["diagnosis"]["lids"][0]["vertices"].get<std::vector<int>>();
  for (int& vertex : vertices) {
    vertex += 3;
  }
  EXPECT_EQ(shifted["diagnosis"]["lids"][0]["vertices"], json(vertices));
}

TEST_F(QualityOfTheMesh, SameBytesForAnyNumberOfThreadsWithAllThatIsOptional) {
  scan({"hand", "scan.ply", "-points", "3000", "-noise", "0.5"});
  std::set<std::string> meshes;
  for (const char* threads : {"1", "2", "3"}) {
    ASSERT_EQ(runTool(directory, {"scan.ply", "out.ply", "-smooth", "4", "-outliers", "3",
                                  "-threads", threads})
                  .exit_code,
              0);
    meshes.insert(tool_test::readFile(directory.file("out.ply")));
  }
  EXPECT_EQ(meshes.size(), 1U);
}

// ------------------------------------------------------------------------------ what is printed

TEST_F(ReconstructionTool, PrintsTheParametersInForce) {
  const auto expect_lines = [&](std::vector<std::string> arguments,
                                const std::vector<std::string>& lines,
                                const std::vector<std::string>& missing) {
    arguments.insert(arguments.begin(), {"in.ply", "out.ply"});
    const RunResult result = runTool(directory, arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    for (const std::string& line : lines) {
      EXPECT_NE(result.output.find("\n  " + line + "\n"), std::string::npos) << line;
    }
    for (const std::string& label : missing) {
      EXPECT_EQ(result.output.find("\n  " + label + " "), std::string::npos) << label;
    }
  };
  expect_lines({},
               {"graph               delaunay", "k                   12",
                "solver              multilevel", "weights             adaptive",
                "exponent            3", "tolerance           off", "lambda              0.5",
                "starts              2", "seed                1", "hull                incremental",
                "optimize            full", "attempts            up to 4"},
               {"iterations", "stagnation", "smooth", "smoothed", "outliers", "attempt 1"});
  expect_lines({"-graph", "knn", "-solver", "iterative", "-hull", "qhull"},
               {"graph               knn", "k                   25",
                "solver              iterative", "tolerance           1e-08",
                "iterations          1600", "stagnation          100", "hull                qhull"},
               {"exponent", "starts", "local Delaunay", "energy", "level"});
  expect_lines({"-solver", "iterative", "-optimize", "none"},
               {"optimize            none", "optimised           no (-optimize none)"}, {"seed"});
  expect_lines({"-optimize", "flips", "-attempts", "7", "-smooth", "3", "-outliers", "3.5"},
               {"optimize            flips", "attempts            up to 7", "smooth              3",
                "outliers            3.5 (paper)"},
               {});
  expect_lines({"-outliers", "6", "-outlier-method", "statistical"},
               {"outliers            6 (statistical)"}, {"smooth", "smoothed"});
  expect_lines({"-exponent", "2.5", "-starts", "7", "-seed", "42", "-tolerance", "1e-5"},
               {"exponent            2.5", "starts              7", "seed                42",
                "tolerance           1e-05"},
               {});
  expect_lines({"-solver", "iterative", "-stagnation", "0", "-iterations", "7"},
               {"stagnation          never", "iterations          7"}, {});
  expect_lines({"-weights", "uniform"}, {"weights             uniform"}, {"exponent"});
}

TEST_F(ReconstructionTool, DrawsABarOnATerminal) {
  RunOptions options;
  options.directory = directory.path();
  options.terminal = true;
  const RunResult result = run(RECONSTRUCTION_TOOL, {"in.ply", "out.ply"}, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("\r  embedding           ["), std::string::npos);
}

TEST_F(ReconstructionTool, TheShareOfTheWholeOnlyGrows) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(5000));
  RunOptions options;
  options.directory = directory.path();
  options.terminal = true;
  const RunResult result =
      run(RECONSTRUCTION_TOOL, {"large.ply", "out.ply", "-smooth", "5"}, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  std::vector<int> shares;
  const std::string label = "  all";
  for (std::size_t i = result.output.find(label); i != std::string::npos;
       i = result.output.find(label, i + 1)) {
    shares.push_back(std::stoi(result.output.substr(i + label.size())));
  }
  ASSERT_GE(shares.size(), 9U);  // each stage tells of its beginning
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << testing::PrintToString(shares);
  EXPECT_EQ(shares.front(), 0);
  EXPECT_GE(shares.back(), 90);
  EXPECT_LE(shares.back(), 100);
}

// Enough points that all stages use their threads, and several levels.
TEST_F(ReconstructionTool, SameBytesForAnyNumberOfThreads) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(20000));
  const std::vector<std::vector<std::string>> methods = {
      {},
      {"-tolerance", "1e-8"},
      {"-weights", "uniform"},
      {"-graph", "knn", "-solver", "iterative", "-iterations", "20", "-hull", "qhull"}};
  for (const std::vector<std::string>& method : methods) {
    std::set<std::string> meshes;
    std::set<std::string> spheres;
    for (const char* threads : {"1", "2", "3"}) {
      std::vector<std::string> arguments = {"large.ply",  "out.ply",  "-sphere",
                                            "sphere.ply", "-threads", threads};
      arguments.insert(arguments.end(), method.begin(), method.end());
      ASSERT_EQ(runTool(directory, arguments).exit_code, 0);
      meshes.insert(tool_test::readFile(directory.file("out.ply")));
      spheres.insert(tool_test::readFile(directory.file("sphere.ply")));
    }
    EXPECT_EQ(meshes.size(), 1U) << testing::PrintToString(method);
    EXPECT_EQ(spheres.size(), 1U) << testing::PrintToString(method);
  }
}

TEST_F(ReconstructionTool, ReplacesAnOldFileAndKeepsItsRightsAndLinks) {
  namespace fs = std::filesystem;
  tool_test::writeFile(directory.file("real.ply"), "old");
  fs::permissions(directory.file("real.ply"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.ply", directory.file("link.ply"));
  ASSERT_EQ(runTool(directory, {"in.ply", "link.ply"}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(directory.file("link.ply")));
  EXPECT_EQ(readPly(directory.file("real.ply")).points, cloud.points);
  EXPECT_EQ(fs::status(directory.file("real.ply")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(ReconstructionTool, SignalsLeaveNothingBehind) {
  // So many points that the signal arrives while they are written.
  const Mesh large = ellipsoid(40000);
  writeCloud(directory.file("large.ply"), "in.ply", large);
  const auto before = directory.listing();
  for (const int signal : {SIGINT, SIGTERM}) {
    RunOptions options;
    options.directory = directory.path();
    options.signal_when_temporary = signal;
    const RunResult result =
        run(RECONSTRUCTION_TOOL, {"large.ply", "out.off", "-sphere", "sphere.off"}, options);
    EXPECT_EQ(result.signal, signal);
    EXPECT_EQ(directory.listing(), before);
  }
}

}  // namespace
