#include "common/text.h"

#include "common/system.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <limits>
#include <system_error>

namespace spherical_param::tools {
namespace {

std::string withoutControls(std::string_view text, char replacement) {
  std::string result(text);
  std::replace_if(
      result.begin(), result.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, replacement);
  return result;
}

/// from_chars() reads no leading plus sign, which people write.
std::string_view withoutPlus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  return text;
}

#ifndef __cpp_lib_to_chars
/// What from_chars() reads, which libc++ lacks for real numbers.
std::optional<double> toRealByStrtod(std::string_view text) {
  const std::string number(text);
  char* end = nullptr;
  const double value = strtodInC(number.c_str(), &end);
  // strtod() also reads spaces, a plus sign and hexadecimal digits.
  const bool is_other = number.empty() || number[0] == '+' ||
                        number.find_first_of(" \t\n\v\f\rxX") != std::string::npos;
  return is_other || end != number.data() + number.size() ? std::nullopt : std::optional(value);
}
#endif

}  // namespace

std::string inQuotes(std::string_view text) {
  constexpr std::size_t longest = 200;
  const bool cut = text.size() > longest;
  return "'" + withoutControls(text.substr(0, longest), '?') + (cut ? "...'" : "'");
}

std::string oneLine(std::string_view text) {
  return withoutControls(text, ' ');
}

std::string replaced(std::string text, char from, char to) {
  std::replace(text.begin(), text.end(), from, to);
  return text;
}

std::string lowerCase(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return result;
}

std::string_view trimmed(std::string_view text, std::string_view around) {
  text = text.substr(std::min(text.find_first_not_of(around), text.size()));
  return text.substr(0, text.find_last_not_of(around) + 1);
}

std::string_view withoutByteOrderMark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.substr(0, mark.size()) == mark ? text.substr(mark.size()) : text;
}

void split(std::string_view text, std::string_view separators,
           std::vector<std::string_view>& parts) {
  parts.clear();
  std::size_t begin = text.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = text.find_first_of(separators, begin);
    parts.push_back(text.substr(begin, end - begin));
    begin = end == std::string_view::npos ? end : text.find_first_not_of(separators, end);
  }
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  split(text, separators, parts);
  return parts;
}

std::optional<double> toReal(std::string_view text) {
  text = withoutPlus(text);
#ifdef __cpp_lib_to_chars
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) {
    return std::nullopt;
  }
  if (error == std::errc::result_out_of_range) {
    // Too large and too small look the same: the exponent's sign distinguishes them.
    // Without one, a digit before the point does.
    const std::size_t exponent = text.find_first_of("eE");
    const bool tiny =
        exponent != std::string_view::npos
            ? text.substr(exponent + 1, 1) == "-"
            : text.substr(0, text.find('.')).find_first_of("123456789") == std::string_view::npos;
    const double magnitude = tiny ? 0.0 : std::numeric_limits<double>::infinity();
    return text.front() == '-' ? -magnitude : magnitude;
  }
  if (error != std::errc()) {
    return std::nullopt;
  }
  return value;
#else
  return toRealByStrtod(text);
#endif
}

std::optional<double> toValue(std::string_view text) {
  if (const std::optional<double> value = toReal(text)) {
    return value;
  }
  std::string plain = lowerCase(text);
  if (plain == "null" || plain == "na" || plain == "n/a") {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::size_t mark = plain.find(".#");  // Microsoft's
  if (mark != std::string::npos && toReal(plain.substr(0, mark))) {
    const bool is_infinite = plain.compare(mark + 2, 3, "inf") == 0;
    const double value = is_infinite ? std::numeric_limits<double>::infinity()
                                     : std::numeric_limits<double>::quiet_NaN();
    return plain[0] == '-' ? -value : value;
  }
  if (std::count(plain.begin(), plain.end(), ',') == 1 && plain.find('.') == std::string::npos) {
    plain[plain.find(',')] = '.';
  }
  const std::size_t exponent = plain.find('d');  // Fortran's
  if (exponent != std::string::npos && exponent > 0) {
    plain[exponent] = 'e';
  }
  return toReal(plain);
}

std::optional<std::int64_t> toInteger(std::string_view text) {
  text = withoutPlus(text);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value)
                                                                  : std::nullopt;
}

std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t end = text.size(); end > 3; end -= 3) {
    text.insert(end - 3, ",");
  }
  return text;
}

std::string withZeros(std::size_t number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return grouped(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

std::string formatted(double value, int digits) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

std::string systemMessage(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace spherical_param::tools
