#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace spherical_param::tools {

/// Checks that a file is there, regular, readable and not empty. \return its size [bytes].
/// \throw Failure.
std::uint64_t checkInputFile(const std::string& path);

/// The first bytes of a file, all of them if it has fewer. \throw Failure.
std::string readBeginning(const std::string& path, std::size_t size);

/// \throw Failure for a file that cannot be read, with the reason.
[[noreturn]] void failReading(const std::string& path, const std::string& reason,
                              const std::string& remedy);

/// \throw Failure for a file whose content is not what its extension promises.
[[noreturn]] void failContent(const std::string& path, const std::string& reason);

}  // namespace spherical_param::tools
