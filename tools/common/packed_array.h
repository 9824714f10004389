#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// Bytes of a number in a packed array.
enum class PackedType { U8 = 1, U16 = 2, U32 = 4 };

/// Rows of unsigned integers, as a page is given them.
struct PackedArray {
  std::string name;
  PackedType type = PackedType::U8;
  std::size_t components = 1;         ///< numbers of a row
  std::vector<std::uint32_t> values;  ///< row after row
  /// For numbers that stand for others: what 0 and the largest number stand for, per component;
  /// empty for plain integers.
  std::vector<double> min;
  std::vector<double> max;

  std::size_t rows() const { return values.size() / components; }
};

/// Rounds numbers to integers of a type, each component between its least and largest number.
///
/// \param values row after row, finite.
PackedArray quantized(const std::string& name, PackedType type, std::size_t components,
                      const std::vector<double>& values);

/// The same between given bounds; what is beyond counts as the bound.
PackedArray quantized(const std::string& name, PackedType type, const std::vector<double>& values,
                      double min, double max, std::size_t components = 1);

/// The array as text: differences of rows, byte planes, deflate (RFC 1950), base64 (RFC 4648).
/// \throw std::bad_alloc
std::string textOf(const PackedArray& array);

/// Base64 (RFC 4648) with padding, without line breaks.
std::string base64(std::string_view bytes);

}  // namespace spherical_param::tools
