#include "common/numbers.h"

#include "common/text.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace spherical_param::tools {
namespace {

/// from_chars() knows no leading plus sign, which people write.
std::string_view withoutPlus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  return text;
}

}  // namespace

std::optional<double> toReal(std::string_view text) {
  text = withoutPlus(text);
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

}  // namespace spherical_param::tools
