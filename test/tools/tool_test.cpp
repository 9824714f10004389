#include "tool_test.h"

#include "helpers.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>

namespace tool_test {

Positions MeshFile::columns(const std::string& a, const std::string& b,
                            const std::string& c) const {
  Positions result(3, static_cast<Eigen::Index>(vertexCount()));
  Eigen::Index row = 0;
  for (const std::string& name : {a, b, c})
    result.row(row++) =
        Eigen::Map<const Eigen::RowVectorXd>(properties.at(name).data(), result.cols());
  return result;
}

bool MeshFile::isSphere() const {
  return spherical_param::test::isSphereOverAll(triangles,
                                                static_cast<spherical_param::Index>(vertexCount()));
}

MeshFile parsePly(const std::string& bytes) {
  MeshFile mesh;
  std::istringstream header(bytes);
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::vector<std::pair<std::string, std::string>> columns;  // types and names
  std::string line;
  while (std::getline(header, line) && line != "end_header") {
    std::istringstream words(line);
    std::string keyword, second, third;
    words >> keyword >> second >> third;
    if (keyword == "comment")
      mesh.comment = line;
    else if (keyword == "element")
      (second == "vertex" ? vertices : triangles) = std::stoul(third);
    else if (keyword == "property" && second != "list")
      columns.emplace_back(second, third);
  }
  EXPECT_EQ(line, "end_header");
  EXPECT_NE(bytes.find("\nformat binary_little_endian "), std::string::npos);
  auto offset = static_cast<std::size_t>(header.tellg());
  const auto next = [&](const std::string& type) {
    const auto take = [&](auto value) {
      if (offset + sizeof value <= bytes.size())
        std::memcpy(&value, bytes.data() + offset, sizeof value);
      offset += sizeof value;
      return static_cast<double>(value);
    };
    return type == "float"    ? take(float{})
           : type == "double" ? take(double{})
           : type == "uchar"  ? take(std::uint8_t{})
                              : take(std::int32_t{});
  };
  for (std::size_t i = 0; i < vertices; ++i)
    for (const auto& [type, name] : columns)
      mesh.properties[name].push_back(next(type));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    EXPECT_EQ(next("uchar"), 3.0);
    for (int k = 0; k < 3; ++k)
      mesh.triangles(k, t) = static_cast<spherical_param::Index>(next("int"));
  }
  EXPECT_EQ(offset, bytes.size());
  return mesh;
}

Positions ellipsoid(int n, const Eigen::Vector3d& axes, const Eigen::Vector3d& center) {
  const Positions points =
      (axes.asDiagonal() * spherical_param::test::spiralSphere(n)).colwise() + center;
  return points.cast<float>().cast<double>();
}

std::string linesOf(const Positions& points) {
  std::ostringstream text;
  text.precision(17);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    text << points(0, i) << " " << points(1, i) << " " << points(2, i) << "\n";
  return text.str();
}

std::string plyOf(const Positions& points, const Positions& normals, const Positions& colors) {
  std::ostringstream text;
  text.precision(17);
  text << "ply\nformat ascii 1.0\nelement vertex " << points.cols()
       << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (normals.cols() > 0)
    text << "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors.cols() > 0)
    text << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  text << "end_header\n";
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (const Positions* part : {&points, &normals, &colors})
      for (int axis = 0; part->cols() > 0 && axis < 3; ++axis)
        text << (*part)(axis, i) << " ";
    text << "\n";
  }
  return text.str();
}

bool containsAll(const Positions& vertices, const Positions& points) {
  const auto places_of = [](const Positions& of) {
    std::set<std::array<double, 3>> places;
    for (Eigen::Index i = 0; i < of.cols(); ++i)
      places.insert({of(0, i), of(1, i), of(2, i)});
    return places;
  };
  const auto all = places_of(vertices);
  const auto some = places_of(points);
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

void expectEntries(const nlohmann::json& report, const nlohmann::json& expected) {
  for (const auto& [key, value] : expected.items()) {
    ASSERT_TRUE(report.contains(key)) << key;
    if (value.is_object()) {
      expectEntries(report[key], value);
    } else {
      EXPECT_EQ(report[key], value) << key;
    }
  }
}

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

RunResult ToolTest::run(const std::string& tool, const std::vector<std::string>& arguments,
                        RunOptions options) const {
  options.directory = directory.path();
  return tool_test::run(tool, arguments, options);
}

RunResult ToolTest::expectSuccess(const std::string& tool,
                                  const std::vector<std::string>& arguments) const {
  RunResult result = run(tool, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return result;
}

nlohmann::json ToolTest::reportOf(const std::string& tool,
                                  const std::vector<std::string>& arguments) const {
  const RunResult result = expectSuccess(tool, with(arguments, {"-json", "-"}));
  return nlohmann::json::parse(result.output, nullptr, false);
}

void ToolTest::expectRefused(const std::string& tool, const std::vector<std::string>& arguments,
                             int exit_code, const std::string& cause, RunOptions options) const {
  const auto before = directory.listing();
  const RunResult result = run(tool, arguments, std::move(options));
  EXPECT_EQ(result.exit_code, exit_code) << "signal " << result.signal;
  const std::vector<std::string> lines = result.errorLines();
  ASSERT_EQ(lines.size(), 2U) << result.errors;
  EXPECT_NE(lines[0].find(cause), std::string::npos) << lines[0];
  const std::string remedy = "  remedy: ";
  EXPECT_EQ(lines[1].rfind(remedy, 0), 0U) << lines[1];
  EXPECT_GT(lines[1].size(), remedy.size());
  EXPECT_TRUE(directory.listing() == before);
}

void ToolTest::write(const std::string& name, const std::string& content) const {
  writeFile(directory.file(name), content);
}

std::string ToolTest::content(const std::string& name) const {
  return readFile(directory.file(name));
}

bool ToolTest::exists(const std::string& name) const {
  return std::filesystem::exists(directory.file(name));
}

}  // namespace tool_test
