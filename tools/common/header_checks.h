#pragma once

#include <cstdint>
#include <string>

namespace spherical_param::tools {

// The readers of PCL and VTK trust the header of a file: they reserve memory for as many points as
// it claims, and follow sizes out of their arrays. So the header is compared with the file first.

/// Checks a PCD file. \throw Failure.
void checkPcdHeader(const std::string& path, std::uint64_t file_size);

/// Checks a PLY file, also for properties that PCL's reader would put in the wrong place.
/// \throw Failure.
void checkPlyHeader(const std::string& path, std::uint64_t file_size);

/// Checks a legacy VTK file. \return the number of points that it declares. \throw Failure.
std::uint64_t checkVtkHeader(const std::string& path, std::uint64_t file_size);

}  // namespace spherical_param::tools
