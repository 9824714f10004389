#pragma once

#include <cstdint>
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

}  // namespace spherical_param::tools
