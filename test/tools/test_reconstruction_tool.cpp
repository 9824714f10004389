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
#include <cstring>
#include <filesystem>
#include <map>
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
  if (extension == ".ply" || extension == ".PLY") {
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

std::string nameOf(const testing::TestParamInfo<Formats::ParamType>& test) {
  std::string name =
      std::get<0>(test.param) + "_" + std::get<1>(test.param) + "_" + std::get<2>(test.param);
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Inputs, Formats,
                         testing::Combine(testing::Values("in.pcd", "ascii.pcd", "compressed.pcd",
                                                          "in.ply", "ascii.ply", "in.obj", "in.xyz",
                                                          "in.txt"),
                                          testing::Values("out.ply"), testing::Values("binary")),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Outputs, Formats,
                         testing::Combine(testing::Values("in.xyz"),
                                          testing::Values("OUT.PLY", "out.obj", "out.stl",
                                                          "out.vtk", "out.off"),
                                          testing::Values("binary", "ascii")),
                         nameOf);

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
  const json report = reportOf({"in.ply", "out.ply", "-k=9"});
  const std::vector<std::pair<std::string, std::string>> keys = {
      {"number_integer",
       "/points /vertices /duplicates /ignored_points /triangles /components /genus /iterations "
       "/peak_memory_bytes /self_intersections /graph/edges /graph/components "
       "/graph/without_tangent_plane_count /graph/searched_again /graph/uncertified /graph/weak "
       "/embedding/starts /embedding/collapsed_starts /triangulation/hull_vertices "
       "/triangulation/reinserted /triangulation/coincident /optimization/noise_steps "
       "/optimization/phases/0/tried /optimization/phases/0/moves "
       "/runs/0/self_intersections /graph/k /options/k /options/starts /options/seed "
       "/options/retries /options/smoothing /options/threads"},
      {"number_float",
       "/residual /edges_outside_graph /stages/0/seconds /embedding/centroid_norm "
       "/embedding/energy /embedding/operator_complexity /embedding/grid_complexity "
       "/optimization/energy /optimization/rough /optimization/alignment "
       "/optimization/unevenness /optimization/phases/0/energy_before "
       "/optimization/phases/0/energy /optimization/phases/0/seconds /runs/0/energy "
       "/runs/0/seconds /measures/volume /measures/area /measures/mean_edge_length "
       "/measures/bounding_box/min/2 /measures/bounding_box/max/2 /measures/centroid/2 "
       "/measures/inertia/2/2 /options/exponent /options/damping"},
      {"boolean",
       "/closed /manifold /oriented /converged /embedding/barrier /embedding/added_barrier "
       "/triangulation/hull_rejected /optimization/noisy /runs/0/chosen "
       "/diagnosis/looks_closed_genus0 /options/strict /options/ascii /options/quiet"},
      {"string",
       "/stop_reason /input /output /version /stages/0/name /graph/method /embedding/method "
       "/triangulation/method /optimization/method /optimization/phases/0/name "
       "/runs/0/description /diagnosis/kind /diagnosis/summary /options/graph /options/embedding "
       "/options/weights /options/triangulation /options/optimization"},
      {"array",
       "/residuals /stages /warnings /self_intersecting_pairs /graph/bridges "
       "/graph/without_tangent_plane /embedding/levels /diagnosis/filled_holes /diagnosis/handles "
       "/diagnosis/bridges"},
      {"null", "/outliers /smoothing /options/tolerance /options/max_iterations "
               "/options/stagnation_window /options/outliers /options/sphere"}};
  const std::map<std::string, bool (json::*)() const noexcept> is_of_type = {
      {"number_integer", &json::is_number_integer},
      {"number_float", &json::is_number_float},
      {"boolean", &json::is_boolean},
      {"string", &json::is_string},
      {"array", &json::is_array},
      {"null", &json::is_null}};
  for (const auto& [type, paths] : keys) {
    std::istringstream words(paths);
    for (std::string path; words >> path;) {
      const json::json_pointer pointer(path);
      EXPECT_TRUE(report.contains(pointer) && (report.at(pointer).*is_of_type.at(type))())
          << path << " " << type;
    }
  }
  EXPECT_EQ(report["points"], 200);
  EXPECT_EQ(report["triangles"], 396);
  EXPECT_EQ(report["genus"], 0);
  // Smoothing is no step to a solution.
  EXPECT_EQ(report["stop_reason"], "unfinished");
  std::vector<std::string> stages;
  for (const json& stage : report["stages"]) {
    stages.push_back(stage["name"]);
  }
  const std::vector<std::string> expected = {"read",      "neighbors",     "graph",
                                             "embedding", "triangulation", "optimization",
                                             "quality",   "write"};
  EXPECT_EQ(stages, expected);
}

TEST_F(ReconstructionTool, ReportOfTheIterationHasAResidualBeforeEachStepAndAtItsEnd) {
  const json report = reportOf({"in.ply", "out.ply", "-embedding", "iterative"});
  EXPECT_GT(report["iterations"], 1);
  EXPECT_EQ(report["residuals"].size(), report["iterations"].get<std::size_t>() + 1);
  EXPECT_EQ(report["residuals"].back(), report["residual"]);
  EXPECT_FALSE(report["embedding"].contains("levels"));
}

TEST_F(ReconstructionTool, ReportHasTheOptionsInForce) {
  const auto expect_options = [&](std::vector<std::string> arguments, const json& expected) {
    arguments.insert(arguments.begin(), {"in.ply", "out.ply"});
    const json options = reportOf(arguments)["options"];
    for (const auto& [name, value] : expected.items()) {
      EXPECT_EQ(options[name], value) << name;
    }
  };
  expect_options({}, {{"graph", "delaunay"},
                      {"k", nullptr},
                      {"embedding", "multilevel"},
                      {"exponent", 3.0},
                      {"starts", 2},
                      {"seed", 1},
                      {"triangulation", "incremental"},
                      {"optimization", "full"},
                      {"retries", 3},
                      {"smoothing", 0}});
  expect_options({"-graph", "knn", "-embedding", "iterative", "-triangulation", "qhull",
                  "-optimization", "none"},
                 {{"graph", "knn"},
                  {"k", nullptr},
                  {"embedding", "iterative"},
                  {"tolerance", nullptr},
                  {"max_iterations", 1600},
                  {"stagnation_window", 100},
                  {"triangulation", "qhull"},
                  {"optimization", "none"},
                  {"retries", nullptr},
                  {"exponent", nullptr},
                  {"starts", nullptr}});
  expect_options({"-weights", "uniform"}, {{"exponent", nullptr}});
  expect_options({"-k", "9", "-seed", "7"}, {{"k", 9}, {"seed", 7}});
  expect_options({"-optimization", "flips", "-smoothing", "3", "-outliers", "2.5"},
                 {{"optimization", "flips"}, {"smoothing", 3}, {"outliers", 2.5}});
  expect_options({"-retries", "1"}, {{"retries", 1}});
}

TEST_F(ReconstructionTool, EachMethodIsTheOneThatWasAskedFor) {
  const json delaunay = reportOf({"in.ply", "out.ply", "-graph", "delaunay"});
  const json knn = reportOf({"in.ply", "out.ply", "-graph", "knn"});
  EXPECT_EQ(knn["graph"]["method"], "knn");
  EXPECT_EQ(knn["graph"]["k"], 25);
  EXPECT_EQ(delaunay["graph"]["k"], 12);
  // 25 neighbours of each of 200 points, and about 6 of each that are Delaunay neighbours.
  EXPECT_GE(knn["graph"]["edges"], 200 * 25 / 2);
  EXPECT_LT(delaunay["graph"]["edges"], 200 * 4);

  const json qhull =
      reportOf({"in.ply", "qhull.ply", "-triangulation", "qhull", "-optimization", "none"});
  const json incremental = reportOf(
      {"in.ply", "incremental.ply", "-triangulation", "incremental", "-optimization", "none"});
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
      {"-k", "7", "-weights", "inverse", "in.ply", "-max_iterations", "3", "out.ply", "-damping",
       "0.25", "-embedding", "iterative"},
      {"--k", "7", "in.ply", "out.ply", "--weights", "inverse", "--max_iterations", "3",
       "--damping", "0.25", "--embedding", "iterative"},
      {"in.ply", "--k=7", "--weights=inverse", "out.ply", "--max_iterations=3", "--damping=0.25",
       "--embedding=iterative"},
      {"in.ply", "out.ply", "-k=7", "-weights=inverse", "-max_iterations=3", "-damping=+.25",
       "-embedding=iterative"},
  };
  std::set<std::string> meshes;
  for (const auto& arguments : notations) {
    const json report = reportOf(arguments);
    EXPECT_EQ(report["options"]["k"], 7);
    EXPECT_EQ(report["options"]["weights"], "inverse");
    EXPECT_EQ(report["options"]["damping"], 0.25);
    EXPECT_EQ(report["iterations"], 3);
    EXPECT_EQ(report["input"], "in.ply");
    meshes.insert(tool_test::readFile(directory.file("out.ply")));
  }
  EXPECT_EQ(meshes.size(), 1U);
}

TEST_F(ReconstructionTool, StandardOutputIsTheReportAlone) {
  const RunResult result = runTool(directory, {"in.ply", "out.ply", "-json", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  EXPECT_TRUE(json::accept(result.output));
}

TEST_F(ReconstructionTool, PointsFarFromTheOriginKeepTheirDigits) {
  const auto offset_cloud = [&](double offset) {
    std::string text;
    for (const Point& point : cloud.points) {
      std::array<char, 128> line{};
      std::snprintf(line.data(), line.size(), "%.17g %.17g %.17g\n", offset + point[0],
                    offset + point[1], offset + point[2]);
      text += line.data();
    }
    return text;
  };
  const auto mesh_of = [&](double offset) {
    tool_test::writeFile(directory.file("offset.xyz"), offset_cloud(offset));
    reportOf({"offset.xyz", "out.ply", "-ascii"});
    return tool_test::readFile(directory.file("out.ply"));
  };
  EXPECT_NE(mesh_of(0.1).find("property float x"), std::string::npos);
  const std::string mesh = mesh_of(5e5);  // as in UTM coordinates
  EXPECT_NE(mesh.find("property double x"), std::string::npos);
  std::istringstream rows(mesh.substr(mesh.find("end_header\n") + 11));
  for (const Point& point : cloud.points) {
    for (const float coordinate : point) {
      double value = 0.0;
      rows >> value;
      EXPECT_EQ(value, 5e5 + coordinate);
    }
  }
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
  const std::vector<Case> cases = {{{}, 2048.0},
                                   {{"-graph", "knn", "-embedding", "iterative", "-max_iterations",
                                     "3", "-triangulation", "qhull"},
                                    2048.0},
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
         {"-graph NAME", "-k N", "-embedding NAME", "-weights NAME", "-exponent X", "-tolerance X",
          "-damping X", "-max_iterations N", "-stagnation_window N", "-starts N", "-seed N",
          "-triangulation NAME", "-optimization NAME", "-retries N", "-smoothing N",
          "-outliers SIGMA", "-strict", "-threads N"}) {
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
  for (const char* word :
       {"graph               delaunay", "embedding", "write", "points              200",
        "tangent plane       missing at 0 points", "starts tried        2 (0 collapsed)",
        "triangles           396", "closed              yes", "genus               0",
        "hull vertices       200 (0 put back, 0 coincident)", "converged           not asked for",
        "self-intersections  0", "looks like          a closed genus-0 surface."}) {
    EXPECT_NE(result.output.find(std::string("\n  ") + word), std::string::npos) << word;
  }
  EXPECT_NE(result.output.find(" (1 component, 0 bridges)\n"), std::string::npos);
}

// --------------------------------------------------------------------------- quality of the mesh

Eigen::Vector3d position(const Point& point) {
  return Eigen::Vector3f(point.data()).cast<double>();
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
  EXPECT_EQ(lines[1].rfind("  remedy: the files were written", 0), 0U) << lines[1];
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

TEST_F(QualityOfTheMesh, WithoutOptimizationTheMeshIsThatOfTheSphere) {
  scan({"hand", "scan.ply", "-points", "3000"});
  const std::vector<std::string> raw_run = {"scan.ply",   "raw.ply",       "-sphere",
                                            "sphere.ply", "-optimization", "none"};
  const json raw = reportOf(raw_run);
  EXPECT_EQ(raw["optimization"]["method"], "none");
  EXPECT_TRUE(raw["optimization"]["phases"].empty());
  EXPECT_EQ(raw["runs"].size(), 1U);
  EXPECT_EQ(edgesOffTheHull(meshFile("sphere.ply")), 0);
  EXPECT_EQ(meshFile("sphere.ply").triangles, meshFile("raw.ply").triangles);

  const json full = reportOf({"scan.ply", "full.ply", "-sphere", "sphere.ply"});
  EXPECT_GT(edgesOffTheHull(meshFile("sphere.ply")), 0);
  const json flips = reportOf({"scan.ply", "flips.ply", "-optimization", "flips"});
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
  const json report = reportOf({"scan.ply", "out.ply", "-optimization", "none"});
  const Mesh mesh = meshFile("out.ply");
  const auto pairs = selfIntersections(mesh);
  // More than are listed.
  ASSERT_GT(pairs.size(), 1000U);
  EXPECT_EQ(report["self_intersections"], pairs.size());
  for (std::size_t i = 0; i < report["self_intersecting_pairs"].size(); ++i) {
    EXPECT_EQ(report["self_intersecting_pairs"][i], json(pairs[i]));
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
      runTool(directory, {"noisy.ply", "out.ply", "-smoothing", "3", "-json", "report.json"});
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
  EXPECT_NEAR(report["measures"]["volume"].get<double>(), volumeOf(unsmoothed), 1e-9);
  for (const char* line : {"\n  smoothing           3\n", "\n  smoothed            3 steps, "}) {
    EXPECT_NE(result.output.find(line), std::string::npos) << line;
  }
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
  const RunResult result =
      runTool(directory, {"outliers.xyz", "out.ply", "-outliers", "5", "-json", "report.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(tool_test::readFile(directory.file("report.json")));
  const json& outliers = report["outliers"];
  EXPECT_EQ(outliers["sigma"], 5.0);
  EXPECT_EQ(outliers["count"], expected.size());
  EXPECT_EQ(outliers["indices"], json(expected));
  EXPECT_TRUE(outliers["threshold"].is_number_float());
  EXPECT_EQ(report["points"], line);
  EXPECT_EQ(report["vertices"], surface.points.size());
  EXPECT_EQ(report["ignored_points"], 1);
  EXPECT_EQ(report["duplicates"], 0);
  EXPECT_EQ(report["stages"][1]["name"], "outliers");
  const Mesh mesh = meshFile("out.ply");
  EXPECT_EQ(mesh.points, surface.points);
  expectSphere(mesh);
  EXPECT_NE(result.output.find("\n  outliers            10 left out\n"), std::string::npos);
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
  ASSERT_EQ(plain["diagnosis"]["filled_holes"].size(), 1U);
  ASSERT_EQ(shifted["diagnosis"]["filled_holes"].size(), 1U);
  auto vertices = plain["diagnosis"]["filled_holes"][0]["vertices"].get<std::vector<int>>();
  for (int& vertex : vertices) {
    vertex += 3;
  }
  EXPECT_EQ(shifted["diagnosis"]["filled_holes"][0]["vertices"], json(vertices));
}

TEST_F(QualityOfTheMesh, SameBytesForAnyNumberOfThreadsWithAllThatIsOptional) {
  scan({"hand", "scan.ply", "-points", "3000", "-noise", "0.5"});
  std::set<std::string> meshes;
  for (const char* threads : {"1", "2", "3"}) {
    ASSERT_EQ(runTool(directory, {"scan.ply", "out.ply", "-smoothing", "4", "-outliers", "3",
                                  "-threads", threads})
                  .exit_code,
              0);
    meshes.insert(tool_test::readFile(directory.file("out.ply")));
  }
  EXPECT_EQ(meshes.size(), 1U);
}

// ------------------------------------------------------------------------------ what is printed

TEST_F(ReconstructionTool, ATerminalShowsABarOfEachStage) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(5000));
  RunOptions options;
  options.directory = directory.path();
  options.terminal = true;
  const RunResult result =
      run(RECONSTRUCTION_TOOL, {"large.ply", "out.ply", "-smoothing", "5"}, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const char* stage : {"read", "neighbors", "graph", "embedding", "triangulation",
                            "optimization", "smoothing", "quality", "write"}) {
    const std::string label =
        "\r  " + std::string(stage) + std::string(20 - std::strlen(stage), ' ');
    EXPECT_NE(result.output.find(label + "["), std::string::npos) << stage;
  }
}

// Enough points that all stages use their threads, and several levels.
TEST_F(ReconstructionTool, SameBytesForAnyNumberOfThreads) {
  writeCloud(directory.file("large.ply"), "in.ply", ellipsoid(20000));
  const std::vector<std::vector<std::string>> methods = {{},
                                                         {"-tolerance", "1e-8"},
                                                         {"-weights", "uniform"},
                                                         {"-graph", "knn", "-embedding",
                                                          "iterative", "-max_iterations", "20",
                                                          "-triangulation", "qhull"}};
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
