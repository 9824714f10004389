#pragma once

#include "common/block_reader.h"
#include "common/point_data.h"

#include <string>

namespace spherical_param::tools {

/// Reads the points of a .pcd, .ply, .obj, .vtk, .xyz or .txt file with their colours and normals.
/// Coordinates that are not finite are kept. Besides the points, a block of the file is in memory,
/// but for .vtk and compressed .pcd, which have to be read as a whole.
///
/// \param progress told of the share that is read; may be empty. \throw UsageError, Failure.
PointData readCloud(const std::string& path, const FileProgress& progress = {});

}  // namespace spherical_param::tools
