#pragma once

#include "common/block_reader.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace spherical_param::tools {

/// Unpacks the next bytes of a file, as LibLZF (M. Lehmann) packs them.
///
/// \param packed_size bytes of the file. \param size what they should make.
/// \return none if they are broken, or make another number of bytes.
std::optional<std::string> unpackLzf(BlockReader& reader, std::uint64_t packed_size,
                                     std::size_t size);

}  // namespace spherical_param::tools
