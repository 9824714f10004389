#pragma once

#include <optional>
#include <string>

namespace spherical_param::tools {

/// File formats, named by the extension of a file.
enum class FileFormat { Pcd, Ply, Obj, Vtk, Xyz, Stl, Off };

/// What a file is wanted for.
enum class FileUse { ReadCloud, WriteCloud, WriteMesh };

/// The format that the extension stands for, in upper or lower case; none if it is unknown.
std::optional<FileFormat> formatOf(const std::string& path);

/// The extensions that can be used that way, e.g. ".ply .obj".
std::string extensionsFor(FileUse use);

/// The format of a file that is wanted for a use.
///
/// \param others further extensions that the tool takes, e.g. " .tif".
/// \throw UsageError if the extension is unknown or its format cannot be used that way.
FileFormat requireFormat(const std::string& path, FileUse use, const std::string& others = "");

}  // namespace spherical_param::tools
