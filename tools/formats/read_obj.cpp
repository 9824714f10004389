#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

/// The 0-based index that an OBJ file means: from 1 on, or backwards from the last one.
std::optional<std::size_t> objIndex(std::string_view word, std::size_t count) {
  const std::optional<std::int64_t> number = toInteger(word);
  if (!number || *number == 0) {
    return std::nullopt;
  }
  const std::int64_t index = *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
  if (index < 0 || index >= static_cast<std::int64_t>(count)) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(index);
}

/// What of an OBJ file is not known before its end.
struct ObjContent {
  PointData data;  ///< points only
  std::vector<std::array<double, 3>> colors;
  std::vector<Normal> normals;
  std::vector<std::optional<std::size_t>> normal_of_point;
  bool normals_referenced = false;
};

void readObjCorner(std::string_view word, ObjContent& content) {
  const std::size_t first = word.find('/');
  const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
  if (second == std::string_view::npos) {
    return;
  }
  const auto point = objIndex(word.substr(0, first), content.data.points.size());
  const auto normal = objIndex(word.substr(second + 1), content.normals.size());
  if (point && normal) {
    content.normal_of_point.resize(content.data.points.size());
    content.normal_of_point[*point] = normal;
    content.normals_referenced = true;
  }
}

std::vector<Normal> objNormals(const ObjContent& content) {
  if (!content.normals_referenced) {
    return content.normals.size() == content.data.points.size() ? content.normals
                                                                : std::vector<Normal>();
  }
  std::vector<Normal> normals;
  for (std::size_t i = 0; i < content.data.points.size(); ++i) {
    if (i >= content.normal_of_point.size() || !content.normal_of_point[i]) {
      return {};  // a vertex has no normal: none are kept
    }
    normals.push_back(content.normals[*content.normal_of_point[i]]);
  }
  return normals;
}

}  // namespace

/// Wavefront OBJ: the vertices, with colours (v x y z r g b), and normals as the faces refer to
/// them, or in the order of the vertices if no face does. PCL's reader is not used: it drops the
/// colours and takes the normals in their order, whatever the faces say.
PointData readObj(const std::string& path, const FileProgress& progress) {
  ObjContent content;
  content.data.points.reserve(countLines(path, "v "));
  forEachLine(path, progress, " \t\r", [&](std::size_t line, const Words& words) {
    if (words.empty()) {
      return;
    }
    if (words[0] == "v" || words[0] == "vn") {
      const auto values = threeNumbers(words, 1);
      if (!values) {
        failLine(path, line, "has no three numbers");
      }
      if (words[0] == "vn") {
        content.normals.push_back(toFloat(*values));
        return;
      }
      content.data.points.push_back(*values);
      if (const auto color = threeNumbers(words, 4)) {
        content.colors.push_back(*color);
      }
    } else if (words[0] == "f") {
      for (std::size_t w = 1; w < words.size(); ++w) {
        readObjCorner(words[w], content);
      }
    } else if (words[0].find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
                                          "0123456789/.-\\") != std::string_view::npos) {
      failLine(path, line, "is not a statement of an OBJ file");
    }
  });
  if (content.data.points.empty()) {
    failContent(path, "it has no points");
  }
  std::vector<Normal> normals = objNormals(content);

  PointData data = std::move(content.data);
  data.normals = std::move(normals);
  if (content.colors.size() == data.points.size()) {
    // The usual range is 0 ... 1; some programs write 0 ... 255.
    const bool bytes = std::any_of(
        content.colors.begin(), content.colors.end(), [](const std::array<double, 3>& color) {
          return std::any_of(color.begin(), color.end(), [](double value) { return value > 1.0; });
        });
    for (const std::array<double, 3>& color : content.colors) {
      data.colors.push_back(toColor(color, bytes ? 1.0 : 255.0));
    }
  }
  return data;
}

}  // namespace spherical_param::tools
