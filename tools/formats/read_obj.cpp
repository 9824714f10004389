#include "common/point_table.h"
#include "formats/formats.h"
#include "formats/text_lines.h"

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

/// The content of an OBJ file. Faces, at its end, say which point has which normal.
struct ObjContent {
  std::vector<PointColumn> columns;  ///< x y z red green blue
  std::vector<std::array<double, 3>> normals;
  std::vector<std::optional<std::size_t>> normal_of_point;  ///< by the faces; empty: by none

  std::size_t points() const { return columns[0].values.size(); }
};

void readObjCorner(std::string_view word, ObjContent& content) {
  const std::size_t first = word.find('/');
  const std::size_t second = first == std::string_view::npos ? first : word.find('/', first + 1);
  if (second == std::string_view::npos) {
    return;
  }
  const auto point = objIndex(word.substr(0, first), content.points());
  const auto normal = objIndex(word.substr(second + 1), content.normals.size());
  if (point && normal) {
    content.normal_of_point.resize(content.points());
    content.normal_of_point[*point] = normal;
  }
}

/// Adds the normals, if each point has one.
void addNormals(ObjContent& content) {
  const bool by_faces = !content.normal_of_point.empty();
  if (!by_faces && content.normals.size() != content.points()) {
    return;
  }
  content.normal_of_point.resize(content.points());
  std::vector<PointColumn> columns = {{"nx", false, {}}, {"ny", false, {}}, {"nz", false, {}}};
  for (std::size_t i = 0; i < content.points(); ++i) {
    const std::optional<std::size_t> normal = by_faces ? content.normal_of_point[i] : i;
    if (!normal) {
      return;
    }
    for (std::size_t d = 0; d < 3; ++d) {
      columns[d].values.push_back(content.normals[*normal][d]);
    }
  }
  content.columns.insert(content.columns.end(), columns.begin(), columns.end());
}

}  // namespace

/// Wavefront OBJ: the vertices, with colours (v x y z r g b), and normals as the faces refer to
/// them, or in the order of the vertices if no face does. PCL's reader is not used: it drops the
/// colours and takes the normals in their order, even if the faces say otherwise.
PointData readObj(InputFile& file, const std::vector<std::string>& /*columns*/) {
  ObjContent content;
  const std::size_t count = countLines(file.path(), "v ");
  for (const char* name : {"x", "y", "z", "red", "green", "blue"}) {
    content.columns.push_back({name, false, {}});
    content.columns.back().values.reserve(content.columns.size() > 3 ? 0 : count);
  }
  Words words;
  for (std::string_view line; file.nextLine(line);) {
    split(withoutRemark(line), " \t\r", words);
    if (words.empty()) {
      continue;
    }
    if (words[0] == "vn") {
      content.normals.push_back(requireThreeNumbers(file, words));
    } else if (words[0] == "v") {
      const auto values = requireThreeNumbers(file, words);
      const auto color = threeNumbers(words, 4);
      for (std::size_t d = 0; d < 3; ++d) {
        content.columns[d].values.push_back(values[d]);
        if (color) {
          content.columns[3 + d].values.push_back((*color)[d]);
        }
      }
    } else if (words[0] == "f") {
      for (std::size_t w = 1; w < words.size(); ++w) {
        readObjCorner(words[w], content);
      }
    } else if (words[0].find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
                                          "0123456789/.-\\") != std::string_view::npos) {
      failLine(file, "is not a statement of an OBJ file");
    }
  }
  if (content.points() == 0) {
    failContent(file.path(), "it has no points");
  }
  addNormals(content);
  if (content.columns[3].values.size() != content.points()) {
    content.columns.erase(content.columns.begin() + 3, content.columns.begin() + 6);
  }
  return toPoints(std::move(content.columns));
}

}  // namespace spherical_param::tools
