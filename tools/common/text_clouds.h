#pragma once

#include "common/block_reader.h"
#include "common/point_data.h"

#include <cstdint>
#include <string>

namespace spherical_param::tools {

/// Reads plain text: x y z, then anything. Blanks, commas, semicolons and tabs separate; '#' begins
/// a comment. The first line may be the number of points or the names of the columns. Columns 4 to
/// 6 and 7 to 9 are colours if all of them are whole numbers in 0 ... 255, and normals if all of
/// them have length 1; else they are ignored.
/// \throw Failure with the number of the broken line.
PointData readXyz(const std::string& path, const FileProgress& progress);

/// Reads the vertices of a Wavefront OBJ file, with colours (v x y z r g b) and normals as the
/// faces refer to them, or in the order of the vertices if no face does.
///
/// PCL's reader is not used: it drops the colours and takes the normals in their order, whatever
/// the faces say. \throw Failure with the number of the broken line.
PointData readObj(const std::string& path, const FileProgress& progress);

}  // namespace spherical_param::tools
