#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace spherical_param::tools {

/// The number that a text consists of, whatever the locale. A number too large for a double is
/// infinite; none if anything but the number is in the text.
std::optional<double> toReal(std::string_view text);

/// The same of a number that another program wrote: also 0,5, 1.2D+00, nan(ind), 1.#QNAN and NULL,
/// which is not finite.
std::optional<double> toValue(std::string_view text);

/// The integer of a text; none if it is not an integer or does not fit.
std::optional<std::int64_t> toInteger(std::string_view text);

/// Range of an option's value, both ends included.
struct IntegerRange {
  std::int64_t lowest = 0;
  std::int64_t highest = std::numeric_limits<int>::max();
};

/// Range of an option's value, the upper end included.
struct RealRange {
  double lowest = 0.0;
  double highest = 1.0;
  bool lowest_included = true;
};

/// The value of an option. \throw UsageError that names option, text and range.
std::int64_t parseInteger(const std::string& option, const std::string& text,
                          const IntegerRange& range);

/// The value of an option, finite. \throw UsageError that names option, text and range.
double parseReal(const std::string& option, const std::string& text, const RealRange& range);

/// The value of an option that is any unsigned 64 bit number. \throw UsageError.
std::uint64_t parseUnsigned(const std::string& option, const std::string& text);

}  // namespace spherical_param::tools
