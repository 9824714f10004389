#pragma once

#include "common/input_file.h"
#include "common/mesh_view.h"
#include "common/point_data.h"
#include "common/record_writer.h"

#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// How numbers are stored in formats that have both.
enum class Encoding { Binary, Ascii };

/// \param columns of text, as the user names them; empty: those that the file says.
using CloudReader = PointData(InputFile& file, const std::vector<std::string>& columns);
using MeshFormatWriter = void(RecordWriter& writer, const MeshView& mesh, Encoding encoding);

/// A file format, named by the extension of a file. Functions that do not exist are null.
struct FormatRow {
  std::string_view extension;  ///< with the dot, in lower case
  CloudReader* read_cloud;
  MeshFormatWriter* write_cloud;
  MeshFormatWriter* write_mesh;
  bool has_single_precision = false;  ///< only, if it is binary
  bool has_colors = true;
};

/// All formats. A new one is a file beside this one, its name in the list below, and a row.
extern const std::vector<FormatRow> format_table;

/// Readers throw Failure with the place of what is broken.
CloudReader readPcd, readPly, readObj, readText, readOff, readStl, readGrid;
MeshFormatWriter writePcd, writePly, writeObj, writeVtk, writeXyz, writeStl, writeOff, writeGlb;

}  // namespace spherical_param::tools
