#pragma once

#include "common/file_formats.h"
#include "common/output_file.h"

#include <string>

namespace spherical_param::tools {

/// Writes a mesh, or a plain cloud if there are no triangles, with the colours and normals that
/// the format has room for. Coordinates are written in single precision, and in double where that
/// would move points by more than a millionth of the cloud's extent (but for binary STL).
///
/// The writers of PCL and VTK are not used, because their files could not be trusted (PCL 1.13,
/// VTK 9.1): those of PCL for PLY and OBJ and VTK's for PLY report success on a full disk; VTK's
/// for STL removes whatever has the name of its output when the disk is full, be it a device;
/// VTK's PLY has no normals, PCL's PLY no alpha, PCL's OBJ no colours, VTK's text 6 digits; and
/// neither writes OFF.
///
/// No more than a block of the file is in memory.
///
/// \param progress is called with the fraction that is written; may be empty.
/// \throw Failure if the file cannot be written.
void writeMesh(OutputFile& file, const MeshView& mesh, FileFormat format, Encoding encoding,
               const FileProgress& progress = {});

/// Whether single precision would move points too far: they are far from the origin.
bool needsDouble(const PointData& data);

/// What has to be subtracted from points so that a format keeps their digits: 0, or a round number
/// near their middle if it has single precision only and they are far from the origin.
///
/// \param format null: one that has no mesh.
Point offsetFor(const PointData& data, FileFormat format, Encoding encoding);

/// What a mesh loses in its file, e.g. " (without colours, less 1000, 0, 0)"; empty: nothing.
///
/// \param has_colors of the mesh.
std::string notWritten(bool has_colors, const std::string& path, const Point& offset);

/// The coordinates of points as writeMesh() rounds them.
Positions asWritten(const Positions& points);

}  // namespace spherical_param::tools
