#include "common/numbers.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace spherical_param::tools {
namespace {

/// from_chars() knows no leading plus sign, which people write.
std::string_view withoutPlus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  return text;
}

template <typename Number>
std::optional<Number> toWhole(std::string_view text) {
  text = withoutPlus(text);
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

[[noreturn]] void failNumber(const std::string& option, const std::string& text,
                             const std::string& wanted) {
  throw UsageError("option -" + option + ": " + inQuotes(text) + " is not " + wanted,
                   "give -" + option + " " + wanted);
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
  return toWhole<std::int64_t>(text);
}

std::int64_t parseInteger(const std::string& option, const std::string& text,
                          const IntegerRange& range) {
  const std::optional<std::int64_t> value = toInteger(text);
  if (!value || *value < range.lowest || *value > range.highest) {
    failNumber(option, text,
               "a whole number from " + std::to_string(range.lowest) + " to " +
                   std::to_string(range.highest));
  }
  return *value;
}

double parseReal(const std::string& option, const std::string& text, const RealRange& range) {
  const std::optional<double> value = toReal(text);
  const bool valid = value && std::isfinite(*value) && *value <= range.highest &&
                     (range.lowest_included ? *value >= range.lowest : *value > range.lowest);
  if (!valid) {
    std::ostringstream wanted;
    wanted << "a number " << (range.lowest_included ? "from " : "above ") << range.lowest
           << (range.lowest_included ? " to " : " and up to ") << range.highest;
    failNumber(option, text, wanted.str());
  }
  return *value;
}

std::uint64_t parseUnsigned(const std::string& option, const std::string& text) {
  const std::optional<std::uint64_t> value = toWhole<std::uint64_t>(text);
  if (!value) {
    failNumber(option, text,
               "a whole number from 0 to " +
                   std::to_string(std::numeric_limits<std::uint64_t>::max()));
  }
  return *value;
}

}  // namespace spherical_param::tools
