#pragma once

#include "common/input_file.h"
#include "common/point_data.h"

#include <string>
#include <vector>

namespace spherical_param::tools {

/// Reads the points of a PCD, PLY, OBJ or text file with their colours, normals and other numbers.
/// Coordinates that are not finite are kept. Besides the points, a block of the file is in memory,
/// but for compressed .pcd, whose fields have to be unpacked as a whole.
///
/// PCL's readers are not used: they trust the file, so that a broken one may end the program
/// without a message. Ours are fuzzed (test/fuzz).
///
/// \param progress is called with the fraction that is read; may be empty.
/// \param columns  names of the columns of text, from the first on; "-" leaves one out. Empty: the
///                 names that the file has.
/// \throw UsageError, Failure.
PointData readCloud(const std::string& path, const FileProgress& progress = {},
                    const std::vector<std::string>& columns = {});

/// The names in "x,y,z,-,red,green,blue". \throw UsageError if x, y and z are not among them.
std::vector<std::string> parseColumns(const std::string& text);

}  // namespace spherical_param::tools
