#pragma once

#include "common/input_file.h"
#include "common/text.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the readers of formats with words in lines share.
namespace spherical_param::tools {

using Words = std::vector<std::string_view>;

/// No cloud has more points: indices have 32 bits.
inline constexpr std::int64_t count_limit = std::int64_t{1} << 30;

/// The words of the next line of a header. \return false at the end of the file, or if the header
/// is too long to be one
inline bool nextWords(InputFile& file, Words& words) {
  constexpr std::size_t longest_header = std::size_t{1} << 20;
  const std::string_view next = file.peek(longest_header);
  const bool is_endless =
      next.size() == longest_header && next.find('\n') == std::string_view::npos;
  std::string_view line;
  if (is_endless || file.size() - file.bytesLeft() > longest_header || !file.nextLine(line)) {
    return false;
  }
  split(line, " \t\r,", words);
  return true;
}

/// A number in a header. \throw Failure if it is not a number, or more than points may be.
inline std::int64_t requireCount(const InputFile& file, std::string_view word,
                                 const std::string& what) {
  const std::optional<std::int64_t> count = toInteger(word);
  if (!count || *count < 0 || *count > count_limit) {
    failContent(file.path(), "its number of " + what + " is " + inQuotes(word));
  }
  return *count;
}

/// To be called before the data is read: memory is reserved for as many points as a header claims.
///
/// \param needed number of bytes, as double: products of counts overflow integers in a broken
/// header. \throw Failure if fewer bytes are left than a header needs.
inline void requireBytes(const InputFile& file, double needed) {
  if (needed > static_cast<double>(file.bytesLeft())) {
    failContent(file.path(), "it is shorter than its header says");
  }
}

/// \throw Failure for what is wrong with the last line that was taken.
[[noreturn]] inline void failLine(const InputFile& file, const std::string& reason) {
  failContent(file.path(), "line " + std::to_string(file.lineNumber()) + " " + reason);
}

/// A line without the comment after '#', which is no part of a word: 1.#QNAN is a number.
inline std::string_view withoutRemark(std::string_view line) {
  std::size_t hash = line.find('#');
  while (hash != std::string_view::npos && hash > 0 && line[hash - 1] == '.') {
    hash = line.find('#', hash + 1);
  }
  return line.substr(0, hash);
}

/// The number of lines that begin with some text. To reserve memory for that many points takes less
/// than to let it grow.
inline std::size_t countLines(const std::string& path, std::string_view beginning) {
  InputFile file(path);
  std::size_t count = 0;
  for (std::string_view line; file.nextLine(line);) {
    count += line.substr(0, beginning.size()) == beginning ? 1 : 0;
  }
  return count;
}

/// The three numbers from a word on, if there are any.
inline std::optional<std::array<double, 3>> threeNumbers(const Words& words, std::size_t first) {
  std::array<double, 3> values{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::optional<double> value =
        first + d < words.size() ? toValue(words[first + d]) : std::nullopt;
    if (!value) {
      return std::nullopt;
    }
    values[d] = *value;
  }
  return values;
}

/// The three numbers after the first word of a line, which must be there. \throw Failure
inline std::array<double, 3> requireThreeNumbers(const InputFile& file, const Words& words) {
  const auto values = threeNumbers(words, 1);
  if (!values) {
    failLine(file, "has no three numbers");
  }
  return *values;
}

}  // namespace spherical_param::tools
