#pragma once

#include "common/block_reader.h"
#include "common/point_data.h"
#include "common/record_layout.h"

#include <string>

namespace spherical_param::tools {

/// Reads the points of a PLY or PCD file, with no more memory than they, a block of the file and
/// the words of its longest line take, and all fields where they are packed. PCL's readers have the
/// file, its fields and the points in memory, all at a time, take up to ten times as long for text,
/// and read what a broken file makes them read.
///
/// \param layout compared with the size of the file.
/// \throw Failure if the file is shorter than its header says, or has words for numbers.
PointData readRecords(const std::string& path, const RecordLayout& layout,
                      const FileProgress& progress);

}  // namespace spherical_param::tools
