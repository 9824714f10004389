#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

bool isUnit(const std::array<double, 3>& values) {
  // Files with 3 digits are common: their normals have unit length to about that.
  return std::abs(std::hypot(values[0], values[1], values[2]) - 1.0) < 5e-3;
}

bool isByteColor(const std::array<double, 3>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) {
    return value >= 0.0 && value <= 255.0 && value == std::floor(value);
  });
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

/// Plain text: x y z, then anything. Blanks, commas, semicolons and tabs separate; '#' begins a
/// comment. The first line may be the number of points or the names of the columns. Columns 4 to 6
/// and 7 to 9 are colours if all of them are whole numbers in 0 ... 255, and normals if all of them
/// have length 1; else they are ignored.
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

}  // namespace spherical_param::tools
