#pragma once

#include "common/record_layout.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace spherical_param::tools {

// The header of a file is compared with its size before anything is read: memory is reserved for as
// many points as it claims.

/// Checks the header of a PCD file. \return where its points are. \throw Failure.
RecordLayout checkPcdHeader(const std::string& path, std::uint64_t file_size);

/// Checks the header of a PLY file, also for colours that other programs take for something else.
/// \return where its points are. \throw Failure.
RecordLayout checkPlyHeader(const std::string& path, std::uint64_t file_size);

/// Checks that a file begins as a legacy VTK file. \throw Failure.
void checkVtkHeader(const std::string& path);

/// How many points a legacy VTK file may have, for who plans with it: what the first line that
/// looks like it declares, or, if none does in the beginning of the file, as many as its size has
/// room for. \throw Failure.
std::uint64_t mostVtkPoints(const std::string& path, std::uint64_t file_size);

/// A number in a header. \throw Failure if it is none, or more than points may be.
std::int64_t requireCount(const std::string& path, std::string_view word, const std::string& what);

/// \throw Failure if there are fewer bytes than a header needs.
void requireBytes(const std::string& path, double needed, std::uint64_t available);

}  // namespace spherical_param::tools
