#pragma once

#include "common/block_reader.h"
#include "common/point_data.h"

#include <string>

namespace spherical_param::tools {

/// Reads the points of a legacy VTK file (versions 1 to 5.1, text or bytes) that holds poly data,
/// an unstructured or a structured grid, with its normals and its colours: scalars of 3 or 4 bytes,
/// or an array named Colors, RGB or RGBA. All the rest is gone through, so that a file that is cut
/// or broken is refused.
///
/// VTK's reader is not used: it believes what a file tells, so that a broken one may end the
/// program, and has the whole file in memory.
///
/// \throw Failure.
PointData readVtk(const std::string& path, const FileProgress& progress);

}  // namespace spherical_param::tools
