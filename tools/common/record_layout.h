#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Packed: little endian as well, but all values of one field after those of another, by LZF.
enum class RecordStorage { Text, LittleEndian, BigEndian, Packed };

/// One property of the points of a file.
struct RecordField {
  std::string name;
  char type = 'F';         ///< F real, I signed, U unsigned
  std::size_t size = 4;    ///< bytes of a value
  std::size_t count = 1;   ///< values
  std::size_t offset = 0;  ///< bytes from the beginning of a record
  std::size_t column = 0;  ///< numbers before it on a line of text
};

/// Records of a file that are no points, of which no more is known than how long they are.
struct SkippedElement {
  struct Property {
    std::size_t size = 0;         ///< bytes of a value
    std::size_t length_size = 0;  ///< bytes of the length of a list; 0: one value
    bool are_corners = false;     ///< its values are points of a face
  };
  std::uint64_t count = 0;
  std::vector<Property> properties;  ///< at least one
};

/// Where a file has its points, as its header says.
struct RecordLayout {
  RecordStorage storage = RecordStorage::Text;
  std::uint64_t body = 0;         ///< bytes before the first record
  std::size_t body_line = 0;      ///< lines before the first record
  std::uint64_t points = 0;       ///< number of them
  std::size_t record_size = 0;    ///< bytes of a point
  std::size_t columns = 0;        ///< numbers on a line of text
  std::uint64_t packed_size = 0;  ///< bytes of the file, if they are packed
  std::vector<RecordField> fields;
  std::array<double, 3> sensor{};      ///< its place
  bool has_rows = false;               ///< it has seen them in rows
  std::vector<SkippedElement> before;  ///< the points
  std::vector<SkippedElement> after;   ///< the points, up to their faces; the rest is not read
};

}  // namespace spherical_param::tools
