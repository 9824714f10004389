#pragma once

#include "common/point_data.h"

#include <string>

namespace spherical_param::tools {

/// Reads the points of a .pcd, .ply, .obj, .vtk, .xyz or .txt file with their colours and normals.
/// Coordinates that are not finite are kept. \throw UsageError, Failure.
PointData readCloud(const std::string& path);

}  // namespace spherical_param::tools
