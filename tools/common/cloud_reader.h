#pragma once

#include "common/block_reader.h"
#include "common/point_data.h"

#include <string>

namespace spherical_param::tools {

/// Reads the points of a .pcd, .ply, .obj, .xyz or .txt file with their colours and normals.
/// Coordinates that are not finite are kept. Besides the points, a block of the file is in memory,
/// but for compressed .pcd, whose fields have to be unpacked as a whole.
///
/// PCL's readers are not used: they trust the file, so that a broken one may end the program
/// without a message. Ours are fuzzed (test/fuzz).
///
/// \param progress is called with the fraction that is read; may be empty.
/// \throw UsageError, Failure.
PointData readCloud(const std::string& path, const FileProgress& progress = {});

}  // namespace spherical_param::tools
