#pragma once

#include "common/input_file.h"
#include "common/output_file.h"
#include "spherical_param/map/resampling.h"

#include <string>

namespace spherical_param::tools {

/// Whether the extension is that of a geometry image: .tif or .tiff, in upper or lower case.
bool isGeometryImageFile(const std::string& path);

/// Writes a geometry image as TIFF 6.0: three samples of 32-bit IEEE float for each pixel, x, y and
/// z, without compression, in the byte order of this machine.
///
/// VTK is not used (9.1): its writer reports success if the disk is full as the file is closed, and
/// removes what has the name otherwise; its reader takes such an image for one of bytes, be it one
/// that its writer made.
///
/// \param image at most 16385 pixels along a side, so that offsets have 32 bits.
/// \param progress is called with the fraction that is written; may be empty. \throw Failure.
void writeGeometryImage(OutputFile& file, const GeometryImage& image,
                        const FileProgress& progress = {});

/// Reads a geometry image: the kind of TIFF that writeGeometryImage() writes, in either byte order.
/// Everything in the file is checked.
///
/// \param progress is called with the fraction that is read; may be empty.
/// \throw Failure for anything else than a square of an odd side with finite positions.
GeometryImage readGeometryImage(const std::string& path, const FileProgress& progress = {});

}  // namespace spherical_param::tools
