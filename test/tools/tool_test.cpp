#include "tool_test.h"

#include "helpers.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>

namespace tool_test {
namespace {

/// The values of a PLY file behind its header.
class PlyBody {
public:
  PlyBody(const std::string& bytes, std::size_t offset, bool is_text)
      : bytes_(bytes), offset_(offset), is_text_(is_text),
        text_(is_text ? bytes.substr(offset) : "") {}

  double next(const std::string& type) {
    if (is_text_) {
      double value = 0.0;
      text_ >> value;
      return type == "float" ? static_cast<double>(static_cast<float>(value)) : value;
    }
    if (type == "float")
      return static_cast<double>(take<float>());
    if (type == "double")
      return take<double>();
    return type == "uchar" ? take<std::uint8_t>() : take<std::int32_t>();
  }

  /// Whether that was all.
  bool isAtEnd() {
    std::string more;
    return is_text_ ? !text_.fail() && !(text_ >> more) : offset_ == bytes_.size();
  }

private:
  template <typename Value>
  Value take() {
    Value value{};
    if (offset_ + sizeof value <= bytes_.size())
      std::memcpy(&value, bytes_.data() + offset_, sizeof value);
    offset_ += sizeof value;
    return value;
  }

  const std::string& bytes_;
  std::size_t offset_;
  bool is_text_;
  std::istringstream text_;
};

}  // namespace

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
  bool is_text = true;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::vector<std::pair<std::string, std::string>> columns;  // types and names
  std::string line;
  while (std::getline(header, line) && line != "end_header") {
    std::istringstream words(line);
    std::string keyword, second, third;
    words >> keyword >> second >> third;
    if (keyword == "format")
      is_text = second == "ascii";
    else if (keyword == "comment")
      mesh.comment = line;
    else if (keyword == "element")
      (second == "vertex" ? vertices : triangles) = std::stoul(third);
    else if (keyword == "property" && second != "list")
      columns.emplace_back(second, third);
  }
  EXPECT_EQ(line, "end_header");
  PlyBody body(bytes, static_cast<std::size_t>(header.tellg()), is_text);
  for (std::size_t i = 0; i < vertices; ++i)
    for (const auto& [type, name] : columns)
      mesh.properties[name].push_back(body.next(type));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    EXPECT_EQ(body.next("uchar"), 3.0);
    for (int k = 0; k < 3; ++k)
      mesh.triangles(k, t) = static_cast<spherical_param::Index>(body.next("int"));
  }
  EXPECT_TRUE(body.isAtEnd());
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

RunResult ToolTest::run(const std::string& tool, const std::vector<std::string>& arguments,
                        RunOptions options) const {
  options.directory = directory.path();
  return tool_test::run(tool, arguments, options);
}

nlohmann::json ToolTest::reportOf(const std::string& tool,
                                  std::vector<std::string> arguments) const {
  arguments.insert(arguments.end(), {"-json", "-"});
  const RunResult result = run(tool, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
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
