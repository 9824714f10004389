#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// The text in quotes, with control characters as '?' and cut if it is very long, so that it stays
/// on one line.
std::string inQuotes(std::string_view text);

/// The text with control characters as blanks.
std::string oneLine(std::string_view text);

/// The text with one character in place of another.
std::string replaced(std::string text, char from, char to);

/// The text in lower case (ASCII).
std::string lowerCase(std::string_view text);

/// The text without these characters around it.
std::string_view trimmed(std::string_view text, std::string_view around = " \t\r");

/// The beginning of a file without the byte order mark of UTF-8.
std::string_view withoutByteOrderMark(std::string_view text);

/// The parts of a text between any of the separators; empty parts are left out.
std::vector<std::string_view> split(std::string_view text, std::string_view separators);

/// Splits like split(), into a vector whose memory is used again.
void split(std::string_view text, std::string_view separators,
           std::vector<std::string_view>& parts);

/// The number that a text consists of, in any locale. A number too large for a double is
/// infinite; none if anything but the number is in the text.
std::optional<double> toReal(std::string_view text);

/// The same of a number that another program wrote: also 0,5, 1.2D+00, nan(ind), 1.#QNAN and NULL,
/// which is not finite.
std::optional<double> toValue(std::string_view text);

/// The integer of a text; none if it is not an integer or does not fit.
std::optional<std::int64_t> toInteger(std::string_view text);

/// A number as people write it, e.g. "49,996".
std::string grouped(std::size_t number);

/// A number of at least `digits` digits, with zeros before it.
std::string withZeros(std::size_t number, std::size_t digits);

/// A number with its noun, e.g. "1 point", "2,000 points".
std::string counted(std::size_t count, const std::string& one, const std::string& many = "");

/// A number with the given number of significant digits.
std::string formatted(double value, int digits);

/// Text of an errno value.
std::string systemMessage(int error_number);

}  // namespace spherical_param::tools
