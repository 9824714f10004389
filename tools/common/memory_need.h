#pragma once

#include "common/reconstruction_options.h"

#include <cstdint>
#include <optional>
#include <string>

namespace spherical_param::tools {

/// The number of points in a file, as its header tells, or at most: its lines, where it has no
/// header. None for a file that has no such header or cannot be read.
std::optional<std::uint64_t> pointCountOf(const std::string& path);

/// An upper bound of the memory that meshing so many points takes [bytes]: what the program itself
/// needs and an amount for each point, which depends on the methods. By default 64 MiB and 864
/// bytes a point. What clouds of 100,000 points took was a half to nine tenths of it.
std::uint64_t memoryNeed(std::uint64_t points, const ReconstructionSettings& settings);

/// Memory that may be taken without harm to others [bytes]: four fifths of what is free, or of what
/// the system lets this program have (cgroups), whichever is less. None where it does not tell.
std::optional<std::uint64_t> memoryToSpare();

/// The bytes that a text such as 800M, 4G, 1.5GiB or 2000000 tells (K, M, G, T are powers of 1024).
/// \throw UsageError
std::uint64_t parseBytes(const std::string& option, const std::string& text);

/// A size for people, e.g. "1.5 GB", in the units of parseBytes().
std::string inBytes(std::uint64_t bytes);

}  // namespace spherical_param::tools
