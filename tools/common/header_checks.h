#pragma once

#include "common/record_layout.h"

#include <cstdint>
#include <string>

namespace spherical_param::tools {

// The header of a file is compared with its size before anything is read: memory is reserved for as
// many points as it claims.

/// Checks the header of a PCD file. \return where its points are. \throw Failure.
RecordLayout checkPcdHeader(const std::string& path, std::uint64_t file_size);

/// Checks the header of a PLY file. \return where its points are. \throw Failure.
RecordLayout checkPlyHeader(const std::string& path, std::uint64_t file_size);

}  // namespace spherical_param::tools
