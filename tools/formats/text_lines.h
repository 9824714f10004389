#pragma once

#include "common/input_file.h"
#include "common/text.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the readers of formats whose lines are words share.
namespace spherical_param::tools {

using Words = std::vector<std::string_view>;

/// A line without the comment after '#', which is no part of a word: 1.#QNAN is a number.
inline std::string_view withoutRemark(std::string_view line) {
  std::size_t hash = line.find('#');
  while (hash != std::string_view::npos && hash > 0 && line[hash - 1] == '.') {
    hash = line.find('#', hash + 1);
  }
  return line.substr(0, hash);
}

/// Hands each line to a function, with its number.
template <typename Take>
void forEachLine(const std::string& path, const FileProgress& progress, const Take& take) {
  BlockReader reader(path, 0, progress);
  std::string_view line;
  for (std::size_t number = 1; reader.nextLine(line); ++number) {
    take(number, number == 1 ? withoutByteOrderMark(line) : line);
  }
}

/// The number of lines that begin with some text: so much memory is set aside for points, instead
/// of twice or three times as much while it grows.
inline std::size_t countLines(const std::string& path, std::string_view beginning) {
  std::size_t count = 0;
  forEachLine(path, {}, [&](std::size_t /*number*/, std::string_view line) {
    count += line.substr(0, beginning.size()) == beginning ? 1 : 0;
  });
  return count;
}

/// The three numbers from a word on, if there are any.
inline std::optional<std::array<double, 3>> threeNumbers(const Words& words, std::size_t first) {
  if (words.size() < first + 3) {
    return std::nullopt;
  }
  std::array<double, 3> values{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::optional<double> value = toValue(words[first + d]);
    if (!value) {
      return std::nullopt;
    }
    values[d] = *value;
  }
  return values;
}

/// The same of a line that must have them. \throw Failure
inline std::array<double, 3> requireThreeNumbers(const std::string& path, std::size_t line,
                                                 const Words& words, std::size_t first) {
  const auto values = threeNumbers(words, first);
  if (!values) {
    failContent(path, "line " + std::to_string(line) + " has no three numbers");
  }
  return *values;
}

}  // namespace spherical_param::tools
