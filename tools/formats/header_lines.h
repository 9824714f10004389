#pragma once

#include "common/input_file.h"
#include "common/text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

// Headers of PCD, PLY, OFF and other files. They are compared with the size of the file before
// anything is read: memory is reserved for as many points as they claim.

/// No header is longer, except in broken files.
inline constexpr std::size_t header_limit = std::size_t{1} << 20;

/// No cloud has more points: indices have 32 bits.
inline constexpr std::int64_t count_limit = std::int64_t{1} << 30;

inline constexpr std::string_view blanks = " \t\r,";

/// Goes through the lines of a text.
class Lines {
public:
  explicit Lines(std::string_view text)
      : text_(text), position_(text.size() - withoutByteOrderMark(text).size()) {}

  /// Moves on to the next line. \return false at the end of the text.
  bool next() {
    if (position_ >= text_.size()) {
      return false;
    }
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    words_ = split(text_.substr(position_, end - position_), blanks);
    position_ = std::min(end + 1, text_.size());
    ++number_;
    return true;
  }
  const std::vector<std::string_view>& words() const { return words_; }
  /// Where the next line begins.
  std::size_t position() const { return position_; }
  std::size_t number() const { return number_; }

private:
  std::string_view text_;
  std::size_t position_;
  std::size_t number_ = 0;
  std::vector<std::string_view> words_;
};

/// Bytes of a file behind a line; none if it was shorter when its size was asked for.
inline std::uint64_t bytesBehind(const Lines& lines, std::uint64_t file_size) {
  return file_size - std::min<std::uint64_t>(lines.position(), file_size);
}

/// A number in a header. \throw Failure if it is not a number, or more than points may be.
inline std::int64_t requireCount(const std::string& path, std::string_view word,
                                 const std::string& what) {
  const std::optional<std::int64_t> count = toInteger(word);
  if (!count || *count < 0 || *count > count_limit) {
    failContent(path, "its number of " + what + " is " + inQuotes(word));
  }
  return *count;
}

/// \throw Failure if there are fewer bytes than a header needs.
inline void requireBytes(const std::string& path, double needed, std::uint64_t available) {
  // Products of counts go through double: they overflow any integer in a broken header.
  if (needed > static_cast<double>(available)) {
    failContent(path, "it is shorter than its header says");
  }
}

}  // namespace spherical_param::tools
