#pragma once

#include "formats/formats.h"

#include <string>

namespace spherical_param::tools {

/// A row of the table of formats.
using FileFormat = const FormatRow*;

/// What a file is used for.
enum class FileUse { ReadCloud, WriteCloud, WriteMesh };

/// The format that the extension stands for, in upper or lower case; null if it is unknown.
FileFormat formatOf(const std::string& path);

/// The extensions that can be used that way, e.g. ".ply .obj".
std::string extensionsFor(FileUse use);

/// The extension of a file with its dot, in lower case.
std::string extensionOf(const std::string& path);

/// The format of a file, by its extension. If points are read from text, or from a file with an
/// unknown extension, the content decides.
///
/// \throw UsageError if the extension is unknown or its format cannot be used that way.
FileFormat requireFormat(const std::string& path, FileUse use);

}  // namespace spherical_param::tools
