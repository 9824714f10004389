#pragma once

#include "common/block_reader.h"
#include "common/input_file.h"
#include "common/numbers.h"
#include "common/point_data.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the readers of formats whose lines are words share.
namespace spherical_param::tools {

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
inline std::size_t countLines(const std::string& path, std::string_view beginning) {
  BlockReader reader(path, 0, {});
  std::string_view line;
  std::size_t count = 0;
  while (reader.nextLine(line)) {
    count += line.substr(0, beginning.size()) == beginning ? 1 : 0;
  }
  return count;
}

[[noreturn]] inline void failLine(const std::string& path, std::size_t line,
                                  const std::string& reason) {
  failContent(path, "line " + std::to_string(line) + " " + reason);
}

/// The three numbers from a word on, if there are any.
inline std::optional<std::array<double, 3>> threeNumbers(const Words& words, std::size_t first) {
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

inline Color toColor(const std::array<double, 3>& values, double scale) {
  Color color = {0, 0, 0, 255};
  for (std::size_t c = 0; c < 3; ++c) {
    // The comparison also sorts out what is not a number.
    const double channel = values[c] >= 0.0 ? std::min(values[c] * scale, 255.0) : 0.0;
    color[c] = static_cast<std::uint8_t>(std::lround(channel));
  }
  return color;
}

}  // namespace spherical_param::tools
