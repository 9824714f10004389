#include "common/text_clouds.h"

#include "common/input_file.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

using Words = std::vector<std::string_view>;

/// Hands the words of each line to a function, with the number of the line.
template <typename Take>
void forEachLine(const std::string& path, const FileProgress& progress, std::string_view separators,
                 const Take& take) {
  BlockReader reader(path, 0, progress);
  std::string_view line;
  Words words;
  for (std::size_t number = 1; reader.nextLine(line); ++number) {
    split(line.substr(0, line.find('#')), separators, words);
    take(number, words);
  }
}

/// The number of lines that begin with some text: so much memory is set aside for points, instead
/// of twice or three times as much while it grows.
std::size_t countLines(const std::string& path, std::string_view beginning) {
  BlockReader reader(path, 0, {});
  std::string_view line;
  std::size_t count = 0;
  while (reader.nextLine(line)) {
    count += line.substr(0, beginning.size()) == beginning ? 1 : 0;
  }
  return count;
}

[[noreturn]] void failLine(const std::string& path, std::size_t line, const std::string& reason) {
  failContent(path, "line " + std::to_string(line) + " " + reason);
}

/// The three numbers from a word on, if there are any.
std::optional<std::array<double, 3>> threeNumbers(const Words& words, std::size_t first) {
  if (words.size() < first + 3) {
    return std::nullopt;
  }
  std::array<double, 3> values{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::optional<double> value = toReal(words[first + d]);
    if (!value) {
      return std::nullopt;
    }
    values[d] = *value;
  }
  return values;
}

bool isUnit(const std::array<double, 3>& values) {
  // Files with 3 digits are common: their normals have unit length to about that.
  return std::abs(std::hypot(values[0], values[1], values[2]) - 1.0) < 5e-3;
}

bool isByteColor(const std::array<double, 3>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) {
    return value >= 0.0 && value <= 255.0 && value == std::floor(value);
  });
}

Color toColor(const std::array<double, 3>& values, double scale) {
  Color color = {0, 0, 0, 255};
  for (std::size_t c = 0; c < 3; ++c) {
    // The comparison also sorts out what is not a number.
    const double channel = values[c] >= 0.0 ? std::min(values[c] * scale, 255.0) : 0.0;
    color[c] = static_cast<std::uint8_t>(std::lround(channel));
  }
  return color;
}

/// Three further columns of a plain text file, of which it is not known what they are.
class ColumnTriple {
public:
  explicit ColumnTriple(std::size_t first_column) : first_column_(first_column) {}

  void add(const Words& words) {
    if (!colors_possible_ && !normals_possible_) {
      return;
    }
    const auto values = threeNumbers(words, first_column_);
    colors_possible_ = colors_possible_ && values && isByteColor(*values);
    normals_possible_ = normals_possible_ && values && isUnit(*values);
    if (!colors_possible_ && !normals_possible_) {
      values_ = {};
    } else {
      values_.push_back(toFloat(*values));
    }
  }

  void assignTo(PointData& data) {
    if (normals_possible_ && data.normals.empty()) {
      data.normals = std::move(values_);
    } else if (colors_possible_ && data.colors.empty()) {
      data.colors.reserve(values_.size());
      for (const Normal& values : values_) {
        data.colors.push_back(toColor({values[0], values[1], values[2]}, 1.0));
      }
    }
    values_ = {};
  }

private:
  std::size_t first_column_;
  bool colors_possible_ = true;
  bool normals_possible_ = true;
  std::vector<Normal> values_;  ///< exact for colours
};

bool isColumnTitle(const Words& words) {
  return words.size() >= 3 && lowerCase(words[0]) == "x" && lowerCase(words[1]) == "y" &&
         lowerCase(words[2]) == "z";
}

}  // namespace

PointData readXyz(const std::string& path, const FileProgress& progress) {
  PointData data;
  data.points.reserve(countLines(path, ""));
  std::array<ColumnTriple, 2> further = {ColumnTriple(3), ColumnTriple(6)};
  bool first = true;
  forEachLine(path, progress, " \t\r,;", [&](std::size_t line, const Words& words) {
    if (words.empty()) {
      return;
    }
    const bool heading =
        first && (isColumnTitle(words) || (words.size() == 1 && toInteger(words[0])));
    first = false;
    if (heading) {
      return;
    }
    const auto point = threeNumbers(words, 0);
    if (!point) {
      failLine(path, line, "does not begin with three numbers");
    }
    data.points.push_back(*point);
    for (ColumnTriple& triple : further) {
      triple.add(words);
    }
  });
  if (data.points.empty()) {
    failContent(path, "it has no points");
  }
  for (ColumnTriple& triple : further) {
    triple.assignTo(data);
  }
  return data;
}

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
      failLine(path, line, "is no statement of an OBJ file");
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
