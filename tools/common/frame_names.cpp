#include "common/frame_names.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::tools {
namespace {

constexpr std::size_t fewest_digits = 3;

/// A number with zeros before it.
std::string padded(int number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

[[noreturn]] void refuse(const std::string& pattern) {
  throw UsageError("the output " + inQuotes(pattern) + " has a % that is no number of a frame",
                   "give one placeholder, as in frame_%03d.ply, or none");
}

}  // namespace

std::vector<std::string> frameNames(const std::string& pattern, int frames) {
  const std::size_t slash = pattern.rfind('/');
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t percent = pattern.find('%', begin);
  std::string before;
  std::string after;
  std::size_t digits = std::max(fewest_digits, std::to_string(frames - 1).size());
  if (percent == std::string::npos) {
    const std::size_t dot = pattern.rfind('.');
    const std::size_t end = dot == std::string::npos || dot < begin ? pattern.size() : dot;
    before = pattern.substr(0, end) + "_";
    after = pattern.substr(end);
  } else {
    // The text between % and d is nothing, or a 0 and one digit from 1 to 9.
    const std::size_t d =
        percent + 1 < pattern.size() && pattern[percent + 1] == '0' ? percent + 3 : percent + 1;
    if (d >= pattern.size() || pattern[d] != 'd' ||
        pattern.find('%', percent + 1) != std::string::npos) {
      refuse(pattern);
    }
    digits = 1;
    if (d == percent + 3) {
      if (pattern[percent + 2] < '1' || pattern[percent + 2] > '9') {
        refuse(pattern);
      }
      digits = static_cast<std::size_t>(pattern[percent + 2] - '0');
    }
    before = pattern.substr(0, percent);
    after = pattern.substr(d + 1);
  }
  std::vector<std::string> names;
  names.reserve(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) {
    names.push_back(before + padded(frame, digits) + after);
  }
  return names;
}

}  // namespace spherical_param::tools
