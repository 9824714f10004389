#pragma once

#include "common/input_file.h"
#include "common/point_data.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Packed: little endian as well, but all values of one field after those of another, by LZF.
enum class RecordStorage { Text, LittleEndian, BigEndian, Packed };

/// One property of a record.
struct RecordField {
  std::string name;
  char type = 'F';              ///< F real, I signed, U unsigned, T any word of a text
  std::size_t size = 4;         ///< bytes of a value
  std::size_t count = 1;        ///< values
  std::size_t length_size = 0;  ///< bytes of the length of a list, which is skipped; 0: no list
};

/// Records of one kind: points, faces or others.
struct RecordElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<RecordField> fields;  ///< at least one
};

/// What a file has, as its header says.
struct RecordLayout {
  RecordStorage storage = RecordStorage::Text;
  std::uint64_t packed_size = 0;        ///< bytes of the file, if they are packed
  std::vector<RecordElement> elements;  ///< in their order; one is "vertex", and perhaps one "face"
};

/// Reads the points of a PLY, PCD or OFF file. In memory are the points, a block of the file and
/// its longest line; of packed files, all fields. PCL's readers hold file, fields and points in
/// memory at the same time, take up to ten times as long for text, and trust a broken file.
///
/// \param file   behind its header. \param layout compared with the size of the file.
/// \throw Failure if the file is shorter than its header says, or has words for numbers.
PointData readRecords(InputFile& file, const RecordLayout& layout);

}  // namespace spherical_param::tools
