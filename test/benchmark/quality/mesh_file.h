#pragma once

#include "mesh_quality.h"

#include <string>

namespace spherical_param::benchmark {

/// Reads the triangles of a .ply file, with coordinates as exact as they are stored. Faces with
/// more corners are cut into triangles from their first corner.
/// \throw Failure of the tools, also for a file without triangles, an index without vertex or a
/// coordinate that is not finite.
Mesh readMesh(const std::string& path);

}  // namespace spherical_param::benchmark
