#pragma once

#include "common/record_layout.h"

#include <cstdint>
#include <string>

namespace spherical_param::tools {

// The readers of PCL and VTK trust the header of a file: they reserve memory for as many points as
// it claims, and follow sizes out of their arrays. So the header is compared with the file first.
// Our own reader of records relies on that as well.

/// Checks the header of a PCD file. \return where its points are. \throw Failure.
RecordLayout checkPcdHeader(const std::string& path, std::uint64_t file_size);

/// Checks the header of a PLY file, also for properties that PCL's reader would put in the wrong
/// place. \return where its points are. \throw Failure.
RecordLayout checkPlyHeader(const std::string& path, std::uint64_t file_size);

/// Checks a legacy VTK file. \return the number of points that it declares. \throw Failure.
std::uint64_t checkVtkHeader(const std::string& path, std::uint64_t file_size);

}  // namespace spherical_param::tools
