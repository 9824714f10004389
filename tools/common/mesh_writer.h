#pragma once

#include "common/block_reader.h"
#include "common/file_formats.h"
#include "common/mesh_view.h"
#include "common/output_file.h"
#include "common/point_data.h"

namespace spherical_param::tools {

/// How numbers are stored in formats that know both.
enum class Encoding { Binary, Ascii };

/// Writes a mesh, or a plain cloud if there are no triangles, with the colours and normals that
/// the format has room for. Binary coordinates are exact, text has 9 digits.
///
/// The writers of PCL and VTK are not used, because their files could not be trusted (PCL 1.13,
/// VTK 9.1): those of PCL for PLY and OBJ and VTK's for PLY report success on a full disk; VTK's
/// for STL removes whatever has the name of its output when the disk is full, be it a device;
/// VTK's PLY has no normals, PCL's PLY no alpha, PCL's OBJ no colours, VTK's text 6 digits; and
/// neither knows OFF.
///
/// A block of the file is in memory, not more.
///
/// \param progress told of the share that is written; may be empty.
/// \throw Failure if the file cannot be written.
void writeMesh(OutputFile& file, const MeshView& mesh, FileFormat format, Encoding encoding,
               const FileProgress& progress = {});

}  // namespace spherical_param::tools
